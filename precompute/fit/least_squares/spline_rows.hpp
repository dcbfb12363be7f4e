// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of linear systems whose unknowns are spline coefficients.
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "palpate/format/response_layout.hpp"
#include "palpate/format/spline.hpp"

namespace palpate::fit {

/// Row r with r . coefs = value of the basis combination.
inline Eigen::RowVectorXd dense_row(int count, const spline::Basis& basis) {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(count);
  for (int i = 0; i < 4; ++i) row[basis.first + i] += basis.weight[i];
  return row;
}

/// Value at u in [0, 1].
inline Eigen::RowVectorXd value_row(int count, double u) { return dense_row(count, spline::basis(count, u)); }

/// First derivative with respect to u.
inline Eigen::RowVectorXd slope_row(int count, double u) { return dense_row(count, spline::slope_basis(count, u)); }

/// Third derivative (constant) in an interval, in units of one interval.
inline Eigen::RowVectorXd third_row(int count, int interval) {
  const int intervals = count - 3;
  const auto slope = [&](double t) { return slope_row(count, (interval + t) / intervals); };
  return (slope(0.75) - 2.0 * slope(0.5) + slope(0.25)) * (16.0 / intervals);
}

/// Second derivative in the middle of an interval, in units of one interval.
inline Eigen::RowVectorXd second_row(int count, int interval) {
  const int intervals = count - 3;
  const auto slope = [&](double t) { return slope_row(count, (interval + t) / intervals); };
  return (slope(0.75) - slope(0.25)) * (2.0 / intervals);
}

/// Jumps of the third derivative at the inner knots; zero when the spline is one cubic all over.
inline Eigen::MatrixXd jump_rows(int count) {
  const int intervals = count - 3;
  Eigen::MatrixXd rows(intervals - 1, count);
  for (int i = 0; i + 1 < intervals; ++i) rows.row(i) = third_row(count, i + 1) - third_row(count, i);
  return rows;
}

/// Second derivatives of every interval; zero when the spline is a straight line.
inline Eigen::MatrixXd bend_rows(int count) {
  const int intervals = count - 3;
  Eigen::MatrixXd rows(intervals, count);
  for (int i = 0; i < intervals; ++i) rows.row(i) = second_row(count, i);
  return rows;
}

/// bend_rows and jump_rows: zero of a straight line. Without the jumps a zigzag of coefficients would pass, which bends
/// nowhere in the middle of an interval.
inline Eigen::MatrixXd smooth_rows(int count) {
  const Eigen::MatrixXd bends = bend_rows(count), jumps = jump_rows(count);
  Eigen::MatrixXd rows(bends.rows() + jumps.rows(), count);
  rows << bends, jumps;
  return rows;
}

/// Coefficients of a curve that is level at both ends, by those between the outermost two.
inline Eigen::MatrixXd level_ends(int count) {
  Eigen::MatrixXd level = Eigen::MatrixXd::Zero(count, count - 2);
  level(0, 0) = level(count - 1, count - 3) = 1;
  level.middleRows(1, count - 2).setIdentity();
  return level;
}

/// Abscissa of a bonded contact's depth (m, of either sign) in its curves.
inline double grasp_abscissa(double depth, double scale) {
  return std::clamp(0.5 * (depth / (layout::kBondedRange * scale) + 1), 0.0, 1.0);
}

}  // namespace palpate::fit
