// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/compliance/rest_modes.hpp"

#include "precompute/algebra/spectrum.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate::compliance {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd SignedModes::columns(const std::vector<Index>& rows) const {
  MatrixXd right(vectors.cols(), static_cast<Index>(rows.size()));
  for (std::size_t k = 0; k < rows.size(); ++k) right.col(static_cast<Index>(k)) = vectors.row(rows[k]).transpose();
  right.bottomRows(negative) *= -1;
  return vectors * right;
}

namespace {

// Orthonormal basis of the first `count` left singular vectors of `values`. Right singular vectors are those of the
// Gram matrix, so that singular values below 1e-8 of the largest are noise: far below a tolerance of percents.
MatrixXd leading_basis(const MatrixXd& values, Index count) {
  const algebra::Spectrum<Eigen::Dynamic> gram = algebra::spectrum<Eigen::Dynamic>(values.transpose() * values);
  return (values * gram.vectors.rightCols(count)).colPivHouseholderQr().householderQ() *
         MatrixXd::Identity(values.rows(), count);
}

}  // namespace

SignedModes rest_modes(const MatrixXd& values, const std::vector<Index>& known, Index count) {
  SignedModes modes;
  count = std::min({count, values.cols(), values.rows()});
  modes.vectors.resize(values.rows(), 0);
  if (count == 0) return modes;
  const MatrixXd q = leading_basis(values, count);
  MatrixXd at_known(static_cast<Index>(known.size()), count);
  for (std::size_t k = 0; k < known.size(); ++k) at_known.row(static_cast<Index>(k)) = q.row(known[k]);
  // M at_known^T = Q^T values
  const MatrixXd projected = q.transpose() * values;
  const MatrixXd m = at_known.completeOrthogonalDecomposition().solve(projected.transpose()).transpose();
  const algebra::Spectrum<Eigen::Dynamic> middle = algebra::spectrum<Eigen::Dynamic>(0.5 * (m + m.transpose()));
  std::vector<Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_partition(order.begin(), order.end(), [&](Index k) { return middle.values[k] >= 0; });
  modes.vectors.resize(values.rows(), count);
  for (Index k = 0; k < count; ++k) {
    const Index from = order[static_cast<std::size_t>(k)];
    const double value = middle.values[from];
    modes.vectors.col(k) = std::sqrt(std::abs(value)) * (q * middle.vectors.col(from));
    modes.negative += value < 0 ? 1 : 0;
  }
  return modes;
}

}  // namespace palpate::compliance
