// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the least squares come from the runtime's own law. They are solved without the passivity inequalities, and
// once more within them where the solution breaks one.
#include "precompute/fit/laws/potential_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "formats/io/error.hpp"
#include "palpate/format/response_layout.hpp"
#include "palpate/format/response_rules.hpp"
#include "precompute/fit/laws/friction_limit.hpp"
#include "precompute/fit/laws/pair_samples.hpp"
#include "precompute/fit/least_squares/cone_fit.hpp"
#include "precompute/fit/least_squares/least_squares.hpp"

namespace palpate::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using response::Degrees;
using response::Offsets;

// Samples whose estimated error is above this share of the force count less: shallow contacts of few integration points.
constexpr double kUsualError = 0.05;
// Weights of priors against relative errors of data. They are small, so that priors decide only where no data do.
constexpr double kRidge = 1e-6, kBend = 2e-4, kContinuation = 0.02;
constexpr int kContinuationPoints = 6;

/// Forces of every coefficient alone at one deflection: the rows of x, y, n.
class Columns {
public:
  explicit Columns(const ResponseScales& scales) {
    const int n = response::count(scales.degrees);
    potentials_.reserve(static_cast<std::size_t>(n));
    for (int k = 0; k < n; ++k) potentials_.emplace_back(VectorXd::Unit(n, k), scales);
  }
  [[nodiscard]] Eigen::Matrix<double, 3, Eigen::Dynamic> rows(const Eigen::Vector3d& deflection) const {
    Eigen::Matrix<double, 3, Eigen::Dynamic> rows(3, static_cast<Index>(potentials_.size()));
    for (std::size_t k = 0; k < potentials_.size(); ++k) {
      rows.col(static_cast<Index>(k)) = potentials_[k].force(deflection);
    }
    return rows;
  }

private:
  std::vector<Potential> potentials_;
};

/// Rows of forces over the peak, data first, priors after. The columns of mu are left out.
struct PotentialRows {
  MatrixXd matrix;
  VectorXd target;
};

PotentialRows make_rows(const PairSamples& data, const ResponseScales& scales) {
  const Degrees& d = scales.degrees;
  const Offsets o = response::offsets(d);
  const Columns columns(scales);
  std::vector<RowVectorXd> rows;
  std::vector<double> target;
  const auto add = [&](const RowVectorXd& row, double value) {
    rows.push_back(row.head(o.friction));
    target.push_back(value);
  };
  const auto add_sample = [&](const Sample& s) {
    const double trust = 1 / std::hypot(1.0, s.error_estimate / kUsualError);
    const double w = trust * data.weight(s);
    const auto at = columns.rows(s.deflection);
    for (int axis = 0; axis < 3; ++axis) add(w * data.peak * at.row(axis), w * s.force[axis]);
  };
  for (const Sample* s : data.normal) add_sample(*s);
  for (const Sample* s : data.tangential) {
    if (d.friction_families) add_sample(*s);
  }
  // Beyond the deepest sample the normal curve continues with its slope there.
  const double deepest = data.normal.back()->deflection.z(), step = 1e-4 * deepest;
  for (int k = 1; k <= kContinuationPoints && deepest < scales.depth * (1 - 1e-9); ++k) {
    const double z = deepest + (scales.depth - deepest) * k / kContinuationPoints, run = (z - deepest) / step;
    const auto there = columns.rows({0, 0, z}), here = columns.rows({0, 0, deepest}),
               before = columns.rows({0, 0, deepest - step});
    for (int axis = 0; axis < 3; ++axis) {
      add(kContinuation * (there.row(axis) - here.row(axis) - run * (here.row(axis) - before.row(axis))), 0);
    }
  }
  const auto bend = [&](int first, int components, int terms) {
    for (int c = 0; c < components; ++c) {
      for (int k = 1; k + 1 < terms; ++k) {
        RowVectorXd row = RowVectorXd::Zero(o.end);
        row[first + components * (k - 1) + c] = row[first + components * (k + 1) + c] = kBend;
        row[first + components * k + c] = -2 * kBend;
        add(row, 0);
      }
    }
  };
  bend(0, 1, d.normal - 1);
  bend(o.bias, 2, d.bias - 1);
  if (d.friction_families) {
    bend(o.stiffness, 3, d.stiffness + 1);
    bend(o.coupling, 3, response::from_square(d.stiffness));
  }
  for (int k = 0; k < o.friction; ++k) add(kRidge * RowVectorXd::Unit(o.end, k), 0);
  PotentialRows result{MatrixXd(static_cast<Index>(rows.size()), o.friction), VectorXd(static_cast<Index>(rows.size()))};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    result.matrix.row(static_cast<Index>(k)) = rows[k];
    result.target[static_cast<Index>(k)] = target[k];
  }
  return result;
}

/// The inequalities of response::broken_rule as cones, those of mu excepted.
class Rules {
public:
  explicit Rules(const Degrees& degrees) : d_(degrees), o_(response::offsets(degrees)) {
    for (Index k = 0; k < o_.bias; ++k) {
      if (k == 0) cones_.push_back({{k}, MatrixXd::Ones(1, 1)});
      if (k > 0) cones_.push_back({{k - 1, k}, Eigen::RowVector2d(-1, 1)});
    }
    for (int i = 0; d_.friction_families && i <= d_.stiffness; ++i) {
      for (const int sign : i < 2 ? std::vector{1} : std::vector{1, -1}) add_passive(i, sign);
    }
  }

  [[nodiscard]] const std::vector<Cone>& cones() const { return cones_; }

  /// A point inside all of them: A is 0, and F and K' are moved inside where they lie outside.
  [[nodiscard]] VectorXd start(const VectorXd& coefs) const {
    constexpr double kInside = 1e-3;
    VectorXd x = VectorXd::Zero(o_.friction);
    x.head(o_.coupling) = coefs.head(o_.coupling);
    double last = 0;
    for (int k = 0; k < o_.bias; ++k) last = x[k] = std::max(coefs[k], last + kInside);
    for (int i = 0; d_.friction_families && i <= d_.stiffness; ++i) {
      auto k = x.segment<3>(o_.stiffness + 3 * i);
      k[0] = std::max(k[0], std::hypot(k[1], k[2]) + kInside);
    }
    return x;
  }

private:
  /// The smallest eigenvalue of K' + sign A at least 0.
  void add_passive(int i, int sign) {
    const bool coupled = i >= 2;
    Cone cone;
    cone.rows = MatrixXd::Zero(3, coupled ? 6 : 3);
    for (int c = 0; c < 3; ++c) cone.of.push_back(o_.stiffness + 3 * i + c);
    cone.rows.leftCols<3>().setIdentity();
    for (int c = 0; coupled && c < 3; ++c) cone.of.push_back(o_.coupling + 3 * (i - 2) + c);
    if (coupled) cone.rows.middleCols<3>(3) = sign * Eigen::Matrix3d::Identity();
    cones_.push_back(std::move(cone));
  }

  Degrees d_;
  Offsets o_;
  std::vector<Cone> cones_;
};

/// Coefficients of mu.
VectorXd fit_friction(const std::vector<Sample>& samples, const ResponseScales& scales, const std::string& what) {
  const int n = scales.degrees.friction + 1;
  const Offsets o = response::offsets(scales.degrees);
  const std::vector<std::pair<double, double>> limits = friction_limits(samples, scales.depth);
  const auto count = static_cast<Index>(limits.size());
  MatrixXd matrix = MatrixXd::Zero(count + n - 1, n);
  VectorXd target = VectorXd::Zero(matrix.rows());
  for (int k = 0; k < n; ++k) {
    const Potential unit(VectorXd::Unit(o.end, o.friction + k), scales);
    for (Index i = 0; i < count; ++i) {
      const auto& [depth, limit] = limits[static_cast<std::size_t>(i)];
      target[i] = limit;
      matrix(i, k) = unit.friction(depth);
    }
  }
  for (int k = 0; k + 1 < n; ++k) {  // constant where no data decide
    matrix(count + k, k) = -kContinuation;
    matrix(count + k, k + 1) = kContinuation;
  }
  return solve_nonnegative(matrix, target, what + ", friction coefficient");
}

}  // namespace

Potential::Potential(const VectorXd& coefs, const ResponseScales& scales) {
  law_.set(scales.degrees, coefs.data(), scales.depth, scales.tangential);
}

Eigen::Vector3d Potential::force(const Eigen::Vector2d& tangential, double depth) const {
  if (!(depth > 0)) return Eigen::Vector3d::Zero();
  const runtime::ResponseAtDepth at = law_.at(depth);
  const runtime::Vec2 e{tangential.x(), tangential.y()}, push = at.bias + at.stiffness * e;
  return {-push.x, -push.y, at.normal_force + dot(at.bias_slope, e) + 0.5 * quadratic(at.normal_coupling, e)};
}

double Potential::friction(double depth) const { return law_.at(depth).friction_coefficient; }

Eigen::Vector2d Potential::deepened(double from, double to, const Eigen::Vector2d& tangential) const {
  if (!(from > 0)) return Eigen::Vector2d::Zero();
  const runtime::Vec2 e{tangential.x(), tangential.y()};
  const runtime::Vec2 kept = runtime::solve(law_.at(to).stiffness, law_.at(from).stiffness * e);
  return {kept.x, kept.y};
}

VectorXd fit_potential(const std::vector<Sample>& samples, const ResponseScales& scales, const std::string& what) {
  const PairSamples data = sort_samples(samples, what);
  if (scales.degrees.friction_families && data.tangential.empty()) {
    throw Error(ExitCode::numerical, what + ": a scene with friction needs tangential pushes; there are none");
  }
  const Offsets o = response::offsets(scales.degrees);
  const PotentialRows rows = make_rows(data, scales);
  VectorXd coefs = VectorXd::Zero(o.end);
  coefs.head(o.friction) = solve_linear(rows.matrix, rows.target, what + ", quadratic potential");
  if (response::broken_rule(coefs.data(), scales.degrees, HUGE_VAL) != nullptr) {
    const Rules rules(scales.degrees);
    coefs.head(o.friction) =
        solve_in_cones(rows.matrix, rows.target, rules.cones(), rules.start(coefs), what + ", quadratic potential");
  }
  coefs.head(o.friction) *= data.peak;
  if (scales.degrees.friction_families) coefs.tail(o.end - o.friction) = fit_friction(samples, scales, what);
  return coefs;
}

namespace {

// Empty where rounding up to the inequalities takes more than `bits`.
std::optional<Quantised> quantise(const VectorXd& coefs, const Degrees& degrees, int bits, double largest) {
  const Offsets o = response::offsets(degrees);
  Quantised result;
  result.unit = static_cast<float>(coefs.head(o.friction).cwiseAbs().maxCoeff() / largest);
  std::vector<double> whole(static_cast<std::size_t>(o.end));
  for (int k = 0; k < o.end; ++k) {
    whole[static_cast<std::size_t>(k)] =
        std::round(coefs[k] / (k < o.friction ? static_cast<double>(result.unit) : layout::kFrictionUnit));
  }
  for (int i = 0; degrees.friction_families && i <= degrees.stiffness; ++i) {
    const double least = std::min(response::least_stiffness(whole.data(), degrees, i, 1),
                                  response::least_stiffness(whole.data(), degrees, i, -1));
    if (least < 0) whole[static_cast<std::size_t>(o.stiffness + 3 * i)] += std::ceil(-least);
  }
  for (int k = 0; k < o.end; ++k) {
    const double value = whole[static_cast<std::size_t>(k)];
    if (!(std::abs(value) < (k < o.friction ? std::exp2(bits - 1) : 32768))) return std::nullopt;
    result.coefs.push_back(static_cast<std::int16_t>(value));
  }
  return result;
}

}  // namespace

Quantised quantise(const VectorXd& coefs, const Degrees& degrees, int bits, const std::string& what) {
  // The unit leaves room to round up to the inequalities. A larger unit leaves more where that does not suffice.
  for (double largest = 0.9765625 * std::exp2(bits - 1); largest > 1; largest *= 0.9) {
    if (auto result = quantise(coefs, degrees, bits, largest)) return *result;
  }
  throw Error(ExitCode::numerical, what + ": a coefficient is out of range");
}

VectorXd rounded(const VectorXd& coefs, const Degrees& degrees, int bits, const std::string& what) {
  const Quantised q = quantise(coefs, degrees, bits, what);
  const int friction = response::offsets(degrees).friction;
  VectorXd result(coefs.size());
  for (Index k = 0; k < result.size(); ++k) {
    result[k] = q.coefs[static_cast<std::size_t>(k)] *
                (k < friction ? static_cast<double>(q.unit) : layout::kFrictionUnit);
  }
  return result;
}

}  // namespace palpate::fit
