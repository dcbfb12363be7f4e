// SPDX-License-Identifier: GPL-3.0-or-later
// Assembles and solves the least-squares problems of one pair.
#include "precompute/verify/baselines/separable_fit.hpp"

#include <algorithm>
#include <cmath>

#include "formats/io/error.hpp"
#include "palpate/format/spline.hpp"
#include "precompute/fit/laws/pair_samples.hpp"
#include "precompute/fit/least_squares/least_squares.hpp"
#include "precompute/fit/least_squares/spline_rows.hpp"

namespace palpate::verify {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr int kNormal = 10, kBias = 5, kGrowth = 5, kPhi = 7, kFriction = 5;  // coefficients of a curve

// Weights of priors against relative errors of data. They are small, so that priors decide only where no data do.
constexpr double jump_weight = 3e-3;
constexpr double continuation_weight = 0.02;
constexpr double bend_weight = 1e-2;
constexpr int continuation_points = 8;

class CurveRows {
public:
  explicit CurveRows(int columns) : columns_(columns) {}
  void add(const RowVectorXd& row, double target) {
    entries_.insert(entries_.end(), row.begin(), row.end());
    target_.push_back(target);
  }
  void add(const MatrixXd& rows) {
    for (Eigen::Index i = 0; i < rows.rows(); ++i) add(RowVectorXd(rows.row(i)), 0.0);
  }
  [[nodiscard]] MatrixXd matrix() const {
    using ByRow = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const ByRow>(entries_.data(), static_cast<Eigen::Index>(target_.size()), columns_);
  }
  [[nodiscard]] VectorXd target() const {
    return Eigen::Map<const VectorXd>(target_.data(), static_cast<Eigen::Index>(target_.size()));
  }

private:
  Eigen::Index columns_;
  std::vector<double> entries_, target_;  // row after row
};

struct PairData : fit::PairSamples {
  double reach = 0.0;  // s of the deepest normal sample
};

/// Z and X (m).
struct Scales {
  double depth, tangential;
};

double abscissa(double depth, double scale) { return std::sqrt(std::clamp(depth / scale, 0.0, 1.0)); }

/// Priors of a force curve over s: one cubic where data are scarce. Beyond the deepest sample, at d, the curve continues
/// with its slope in z there, F(z) = F(d) + F'(d) (z - d).
void add_curve_priors(CurveRows& rows, int count, double reach) {
  rows.add(jump_weight * fit::jump_rows(count));
  if (reach > 1 - 1e-9) return;
  for (int k = 1; k <= continuation_points; ++k) {
    const double s = reach + (1 - reach) * k / continuation_points;
    const double run = (s * s - reach * reach) / (2 * reach);
    rows.add(continuation_weight *
                 (fit::value_row(count, s) - fit::value_row(count, reach) - run * fit::slope_row(count, reach)),
             0.0);
  }
}

/// Monotone Fn: unknowns are the increments of the coefficients from the third on.
VectorXd fit_normal(const PairData& data, const Scales& scales, const std::string& what) {
  const int n = kNormal;
  CurveRows rows(n);
  for (const Sample* sample : data.normal) {
    const double w = data.weight(*sample) * data.peak;
    const double s = abscissa(sample->deflection.z(), scales.depth);
    rows.add(w * fit::value_row(n, s), w * sample->force.z() / data.peak);
  }
  add_curve_priors(rows, n, data.reach);
  MatrixXd increments = MatrixXd::Zero(n, n - 2);
  for (int i = 2; i < n; ++i) increments.row(i).head(i - 1).setOnes();
  return data.peak *
         (increments * fit::solve_nonnegative(rows.matrix() * increments, rows.target(), what + ", normal curve"));
}

VectorXd fit_bias(const PairData& data, const Scales& scales, int axis, const std::string& what) {
  const int n = kBias;
  CurveRows rows(n);
  for (const Sample* sample : data.normal) {
    const double w = data.weight(*sample) * data.peak;
    rows.add(w * fit::value_row(n, abscissa(sample->deflection.z(), scales.depth)),
             w * sample->force[axis] / data.peak);
  }
  add_curve_priors(rows, n, data.reach);
  VectorXd coefs = VectorXd::Zero(n);
  coefs.tail(n - 2) =
      data.peak * fit::solve_linear(rows.matrix().rightCols(n - 2), rows.target(), what + ", bias curve");
  return coefs;
}

/// phi(u) = -sum of increments times (integrated spline(u) - the same at 0): zero at 0 and non-increasing for
/// increments >= 0. `t` is u carried from [-1, 1] to [0, 1].
RowVectorXd phi_row(int count, double t) {
  const RowVectorXd values = fit::value_row(count, t) - fit::value_row(count, 0.5);
  RowVectorXd row(count - 1);
  double tail = 0;
  for (int k = count - 1; k >= 1; --k) row[k - 1] = -(tail += values[k]);
  return row;
}

/// The tangential force of a normal indentation: the solved one where this depth was solved, else the curve's.
double bias_at(const PairData& data, const VectorXd& bias, const Scales& scales, double depth, int axis) {
  auto at = std::lower_bound(data.normal.begin(), data.normal.end(), depth,
                             [](const Sample* sample, double z) { return sample->deflection.z() < z; });
  if (at == data.normal.end() ||
      (at != data.normal.begin() && depth - (*(at - 1))->deflection.z() <= (*at)->deflection.z() - depth)) {
    --at;
  }
  const Sample* const nearest = *at;
  if (std::abs(nearest->deflection.z() - depth) <= 1e-3 * depth) return nearest->force[axis];
  return spline::value(bias.data(), kBias, abscissa(depth, scales.depth));
}

/// The rank-one product g(s) phi(u) of one axis.
void fit_product(const PairData& data, const VectorXd& bias, const Scales& scales, int axis,
                  const std::string& what, VectorXd& growth, VectorXd& phi) {
  const int ng = kGrowth, np = kPhi;
  const auto m = static_cast<Eigen::Index>(data.tangential.size());
  fit::ProductProblem problem;
  problem.a.resize(m, ng - 2);
  problem.b.resize(m, np - 1);
  problem.a0.resize(m);
  problem.target.resize(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Sample& sample = *data.tangential[static_cast<std::size_t>(i)];
    const double s = abscissa(sample.deflection.z(), scales.depth);
    const double u = std::clamp(sample.deflection[axis] / scales.tangential, -1.0, 1.0);
    const double force = sample.force[axis] - bias_at(data, bias, scales, sample.deflection.z(), axis);
    const double w = data.weight(sample) * data.peak;
    const RowVectorXd g = fit::value_row(ng, s);
    problem.a.row(i) = g.segment(1, ng - 2);
    problem.a0[i] = g[ng - 1];
    problem.b.row(i) = w * phi_row(np, (u + 1) / 2);
    problem.target[i] = w * force / data.peak;
  }

  // Priors: the stiffness grows like the contact radius, g = s; phi is one smooth, nearly straight curve.
  const MatrixXd bend = fit::bend_rows(ng);
  problem.x_rows = bend_weight * bend.middleCols(1, ng - 2);
  problem.x_target = -bend_weight * bend.col(ng - 1);
  const MatrixXd jumps = fit::jump_rows(np), bends = fit::bend_rows(np);
  MatrixXd smooth(jumps.rows() + bends.rows(), np);
  smooth << jump_weight * jumps, 0.3 * bend_weight * bends;
  MatrixXd cumulative = MatrixXd::Zero(np, np - 1);
  for (int k = 1; k < np; ++k) cumulative.row(k).head(k).setOnes();
  problem.y_rows = smooth * cumulative;

  VectorXd x(ng - 2), y;
  for (int k = 0; k < ng - 2; ++k) x[k] = spline::greville(ng, k + 1);
  fit::solve_product(problem, x, y, what + (axis == 0 ? ", tangential curves x" : ", tangential curves y"));

  growth = VectorXd::Zero(ng);
  growth.segment(1, ng - 2) = x.cwiseMax(0.0);
  growth[ng - 1] = 1.0;
  const VectorXd raw = -data.peak * (cumulative * y.cwiseMax(0.0));
  phi = raw.array() - spline::value(raw.data(), np, 0.5);
}

}  // namespace

SeparableField fit_separable(const std::vector<Sample>& samples, double depth, double tangential,
                             const std::string& what) {
  const Scales scales{depth, tangential};
  PairData data{fit::sort_samples(samples, what)};
  data.reach = abscissa(data.normal.back()->deflection.z(), depth);
  SeparableField field;
  field.depth = depth;
  field.tangential = tangential;
  field.normal = fit_normal(data, scales, what);
  field.bias_x = fit_bias(data, scales, 0, what);
  field.bias_y = fit_bias(data, scales, 1, what);
  if (!(tangential > 0)) return field;
  if (data.tangential.empty()) {
    throw Error(ExitCode::numerical, what + ": a scene with friction needs tangential pushes; there are none");
  }
  fit_product(data, field.bias_x, scales, 0, what, field.growth_x, field.phi_x);
  fit_product(data, field.bias_y, scales, 1, what, field.growth_y, field.phi_y);
  return field;
}

Eigen::Vector3d SeparableField::force(const Eigen::Vector3d& deflection) const {
  const double s = abscissa(deflection.z(), depth);
  Eigen::Vector3d force(spline::value(bias_x.data(), kBias, s), spline::value(bias_y.data(), kBias, s),
                        spline::value(normal.data(), kNormal, s));
  if (!(tangential > 0)) return force;
  const auto u = [&](int axis) { return (std::clamp(deflection[axis] / tangential, -1.0, 1.0) + 1) / 2; };
  force.x() += spline::value(growth_x.data(), kGrowth, s) * spline::value(phi_x.data(), kPhi, u(0));
  force.y() += spline::value(growth_y.data(), kGrowth, s) * spline::value(phi_y.data(), kPhi, u(1));
  return force;
}

double SeparableField::bytes(bool friction) {
  return 4.0 * (kNormal + 2 * kBias + (friction ? 2 * (kGrowth + kPhi) + kFriction : 0));
}

}  // namespace palpate::verify
