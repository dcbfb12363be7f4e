// SPDX-License-Identifier: GPL-3.0-or-later
// Assembles and solves the least-squares problems of one pair.
#include "precompute/fit/pair_fit.hpp"

#include <algorithm>
#include <cmath>

#include "formats/error.hpp"
#include "precompute/fit/friction_limit.hpp"
#include "precompute/fit/least_squares.hpp"
#include "precompute/fit/pair_samples.hpp"
#include "precompute/fit/path_errors.hpp"
#include "precompute/fit/slip_relief.hpp"
#include "precompute/fit/spline_rows.hpp"

namespace palpate::fit {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

// Priors are weak against data (relative errors): they decide only where no data do.
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

struct PairData : PairSamples {
  double reach = 0.0;  // s of the deepest straight push
};

double abscissa(double depth, double scale) { return std::sqrt(std::clamp(depth / scale, 0.0, 1.0)); }

/// Priors of a force curve over s: one cubic where data are scarce; beyond the deepest sample the tangent
/// stiffness in z there goes on, F(z) = F(d) + F'(d) (z - d).
void add_curve_priors(CurveRows& rows, int count, double reach) {
  rows.add(jump_weight * jump_rows(count));
  if (reach > 1 - 1e-9) return;
  for (int k = 1; k <= continuation_points; ++k) {
    const double s = reach + (1 - reach) * k / continuation_points;
    const double run = (s * s - reach * reach) / (2 * reach);
    rows.add(continuation_weight * (value_row(count, s) - value_row(count, reach) - run * slope_row(count, reach)),
             0.0);
  }
}

/// Monotone Fn: unknowns are the increments of the coefficients from the third on.
VectorXd fit_normal(const PairData& data, const ModelScales& scales, const std::string& what) {
  const int n = scales.normal_coefs;
  CurveRows rows(n);
  for (const Sample* sample : data.normal) {
    const double w = data.weight(*sample) * data.peak;
    const double s = abscissa(sample->deflection.z(), scales.depth);
    rows.add(w * value_row(n, s), w * sample->force.z() / data.peak);
  }
  add_curve_priors(rows, n, data.reach);
  MatrixXd increments = MatrixXd::Zero(n, n - 2);
  for (int i = 2; i < n; ++i) increments.row(i).head(i - 1).setOnes();
  return data.peak *
         (increments * solve_nonnegative(rows.matrix() * increments, rows.target(), what + ", normal curve"));
}

VectorXd fit_lateral(const PairData& data, const ModelScales& scales, int axis, const std::string& what) {
  const int n = scales.lateral_coefs;
  CurveRows rows(n);
  for (const Sample* sample : data.normal) {
    const double w = data.weight(*sample) * data.peak;
    rows.add(w * value_row(n, abscissa(sample->deflection.z(), scales.depth)), w * sample->force[axis] / data.peak);
  }
  add_curve_priors(rows, n, data.reach);
  VectorXd coefs = VectorXd::Zero(n);
  coefs.tail(n - 2) = data.peak * solve_linear(rows.matrix().rightCols(n - 2), rows.target(), what + ", lateral curve");
  return coefs;
}

/// mu(s), constant beyond the deepest sample.
VectorXd fit_friction(const PairData& data, const std::vector<Sample>& samples, const ModelScales& scales,
                      double relief, const std::string& what) {
  const int n = scales.friction_coefs;
  CurveRows rows(n);
  for (const auto& [depth, limit] : friction_limits(samples, scales.depth, relief)) {
    rows.add(value_row(n, abscissa(depth, scales.depth)), limit);
  }
  for (int k = 0; k + 1 < n; ++k) {
    RowVectorXd difference = RowVectorXd::Zero(n);
    difference[k] = -bend_weight;
    difference[k + 1] = bend_weight;
    rows.add(difference, 0.0);
  }
  if (data.reach < 1 - 1e-9) {
    for (int k = 1; k <= continuation_points; ++k) {
      const double s = data.reach + (1 - data.reach) * k / continuation_points;
      rows.add(continuation_weight * (value_row(n, s) - value_row(n, data.reach)), 0.0);
    }
  }
  return solve_nonnegative(rows.matrix(), rows.target(), what + ", friction curve");
}

/// phi(u) = -sum of increments times (integrated spline(u) - the same at 0): zero at 0 and non-increasing for
/// increments >= 0. `t` is u carried from [-1, 1] to [0, 1].
RowVectorXd sideways_row(int count, double t) {
  const RowVectorXd values = value_row(count, t) - value_row(count, 0.5);
  RowVectorXd row(count - 1);
  double tail = 0;
  for (int k = count - 1; k >= 1; --k) row[k - 1] = -(tail += values[k]);
  return row;
}

/// The straight push's sideways force at a depth: the solved one where this depth was solved, else the curve's.
double straight_push(const PairData& data, const VectorXd& lateral, const ModelScales& scales, double depth, int axis) {
  auto at = std::lower_bound(data.normal.begin(), data.normal.end(), depth,
                             [](const Sample* sample, double z) { return sample->deflection.z() < z; });
  if (at == data.normal.end() ||
      (at != data.normal.begin() && depth - (*(at - 1))->deflection.z() <= (*at)->deflection.z() - depth)) {
    --at;
  }
  const Sample* const nearest = *at;
  if (std::abs(nearest->deflection.z() - depth) <= 1e-3 * depth) return nearest->force[axis];
  return spline::value(lateral.data(), scales.lateral_coefs, abscissa(depth, scales.depth));
}

/// The rank-one product g(s) phi(u) of one axis.
void fit_sideways(const PairData& data, const VectorXd& lateral, const ModelScales& scales, int axis,
                  const std::string& what, VectorXd& growth, VectorXd& sideways) {
  const int ng = scales.growth_coefs, np = scales.sideways_coefs;
  const auto m = static_cast<Eigen::Index>(data.tangential.size());
  ProductProblem problem;
  problem.a.resize(m, ng - 2);
  problem.b.resize(m, np - 1);
  problem.a0.resize(m);
  problem.target.resize(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Sample& sample = *data.tangential[static_cast<std::size_t>(i)];
    const double s = abscissa(sample.deflection.z(), scales.depth);
    const double u = std::clamp(sample.deflection[axis] / scales.sideways, -1.0, 1.0);
    const double force = sample.force[axis] - straight_push(data, lateral, scales, sample.deflection.z(), axis);
    const double w = data.weight(sample) * data.peak;
    const RowVectorXd g = value_row(ng, s);
    problem.a.row(i) = g.segment(1, ng - 2);
    problem.a0[i] = g[ng - 1];
    problem.b.row(i) = w * sideways_row(np, (u + 1) / 2);
    problem.target[i] = w * force / data.peak;
  }

  // Priors: the stiffness grows like the contact radius, g = s; phi is one smooth, nearly straight curve.
  const MatrixXd bend = bend_rows(ng);
  problem.x_rows = bend_weight * bend.middleCols(1, ng - 2);
  problem.x_target = -bend_weight * bend.col(ng - 1);
  const MatrixXd jumps = jump_rows(np), bends = bend_rows(np);
  MatrixXd smooth(jumps.rows() + bends.rows(), np);
  smooth << jump_weight * jumps, 0.3 * bend_weight * bends;
  MatrixXd cumulative = MatrixXd::Zero(np, np - 1);
  for (int k = 1; k < np; ++k) cumulative.row(k).head(k).setOnes();
  problem.y_rows = smooth * cumulative;

  VectorXd x(ng - 2), y;
  for (int k = 0; k < ng - 2; ++k) x[k] = spline::greville(ng, k + 1);
  solve_product(problem, x, y, what + (axis == 0 ? ", sideways curves x" : ", sideways curves y"));

  growth = VectorXd::Zero(ng);
  growth.segment(1, ng - 2) = x.cwiseMax(0.0);
  growth[ng - 1] = 1.0;
  const VectorXd raw = -data.peak * (cumulative * y.cwiseMax(0.0));
  sideways = raw.array() - spline::value(raw.data(), np, 0.5);
}

}  // namespace

PairCurves fit_pair(const std::vector<Sample>& samples, const ModelScales& scales, const std::string& what) {
  PairCurves curves;
  const StickingForce sticking = [&](const Eigen::Vector3d& deflection) {
    return evaluate(curves, scales, deflection);
  };
  if (scales.coupled) {
    curves.coupled = fit_coupled(samples, coupled_scales(scales), what);
    curves.relief = slip_relief(samples, sticking, scales.depth);
    if (curves.relief > 0) {
      const VectorXd limit = fit_limit(samples, coupled_scales(scales), curves.relief, what);
      curves.coupled.tail(limit.size()) = limit;
    }
    // Errors are of what the file has; of 16 bits nothing is to be seen of it.
    if (scales.bits < 16) curves.coupled = rounded(curves.coupled, *scales.coupled, scales.bits, what);
    return curves;
  }
  PairData data{sort_samples(samples, what)};
  data.reach = abscissa(data.normal.back()->deflection.z(), scales.depth);
  curves.normal = fit_normal(data, scales, what);
  curves.lateral_x = fit_lateral(data, scales, 0, what);
  curves.lateral_y = fit_lateral(data, scales, 1, what);
  if (!scales.friction()) return curves;
  if (data.tangential.empty()) {
    throw Error(ExitCode::numerical, what + ": a scene with friction needs sideways pushes; there are none");
  }
  fit_sideways(data, curves.lateral_x, scales, 0, what, curves.growth_x, curves.sideways_x);
  fit_sideways(data, curves.lateral_y, scales, 1, what, curves.growth_y, curves.sideways_y);
  curves.relief = slip_relief(samples, sticking, scales.depth);
  curves.friction = fit_friction(data, samples, scales, curves.relief, what);
  return curves;
}

Eigen::Vector3d evaluate(const PairCurves& curves, const ModelScales& scales, const Eigen::Vector3d& deflection) {
  if (scales.coupled) {
    const CoupledScales own = coupled_scales(scales);
    return evaluate(make_law(curves.coupled, own), own, deflection);
  }
  const auto at = [](const VectorXd& coefs, double u) {
    return coefs.size() == 0 ? 0.0 : spline::value(coefs.data(), static_cast<int>(coefs.size()), u);
  };
  const double s = abscissa(deflection.z(), scales.depth);
  Eigen::Vector3d force(at(curves.lateral_x, s), at(curves.lateral_y, s), at(curves.normal, s));
  if (scales.friction()) {
    const auto u = [&](int axis) { return (std::clamp(deflection[axis] / scales.sideways, -1.0, 1.0) + 1) / 2; };
    force.x() += at(curves.growth_x, s) * at(curves.sideways_x, u(0));
    force.y() += at(curves.growth_y, s) * at(curves.sideways_y, u(1));
  }
  return force;
}

double evaluate_friction(const PairCurves& curves, const ModelScales& scales, double depth) {
  if (curves.friction.size() == 0) return 0.0;
  return spline::value(curves.friction.data(), static_cast<int>(curves.friction.size()), abscissa(depth, scales.depth));
}

FitErrors fit_errors(const PairCurves& curves, const ModelScales& scales, const std::vector<Sample>& samples) {
  FitErrors errors;
  const PairSamples data = sort_samples(samples, "errors");
  const auto error = [&](const Sample* s) {
    return (evaluate(curves, scales, s->deflection) - s->force).norm() * data.weight(*s);
  };
  for (const Sample* s : data.normal) errors.normal.push_back(error(s));
  for (const Sample* s : data.tangential) errors.tangential.push_back(error(s));
  if (scales.coupled) {
    const CoupledScales own = coupled_scales(scales);
    const coupled::Law law = make_law(curves.coupled, own);
    errors.paths = path_errors(
        samples, data, [&](const Eigen::Vector2d& e, double depth) { return evaluate(law, own, e, depth); },
        [&](double from, double to, const Eigen::Vector2d& e) { return deepened(law, own, from, to, e); });
  } else {  // it knows no past: what it holds is where the tool is
    errors.paths = path_errors(
        samples, data,
        [&](const Eigen::Vector2d& e, double depth) {
          return evaluate(curves, scales, {e.x(), e.y(), depth});
        },
        [](double, double, const Eigen::Vector2d& e) { return e; });
  }
  return errors;
}

}  // namespace palpate::fit
