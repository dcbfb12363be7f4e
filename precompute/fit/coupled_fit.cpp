// SPDX-License-Identifier: GPL-3.0-or-later
// CoupledRows from the runtime's own law, solved without the rules that make it passive, and within them where it broke
// one.
#include "precompute/fit/coupled_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "formats/error.hpp"
#include "palpate/format/response_rules.hpp"
#include "palpate/format/response_layout.hpp"
#include "precompute/fit/cone_fit.hpp"
#include "precompute/fit/friction_limit.hpp"
#include "precompute/fit/least_squares.hpp"
#include "precompute/fit/pair_samples.hpp"

namespace palpate::fit {
namespace {

using coupled::Degrees;
using coupled::Law;
using coupled::Vec2;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

// Errors estimated above this count less: those of shallow contacts of few integration points.
constexpr double kUsualError = 0.05;
// Weak against data (relative errors): they decide only where no data do.
constexpr double kRidge = 1e-6, kBend = 2e-4, kContinuation = 0.02;
constexpr int kContinuationPoints = 6;

Vec2 scaled(const Eigen::Vector3d& deflection, double scale) {
  return {deflection.x() / scale, deflection.y() / scale};
}

/// Answers of every coefficient alone, at a place: the rows of x, y, n.
class Columns {
public:
  explicit Columns(const CoupledScales& scales) : scales_(scales) {
    const int n = coupled::count(scales.degrees);
    for (int k = 0; k < n; ++k) laws_.push_back(make_law(VectorXd::Unit(n, k), scales));
  }
  [[nodiscard]] Eigen::Matrix<double, 3, Eigen::Dynamic> rows(double depth, const Vec2& u) const {
    Eigen::Matrix<double, 3, Eigen::Dynamic> rows(3, static_cast<Eigen::Index>(laws_.size()));
    for (std::size_t k = 0; k < laws_.size(); ++k) {
      const Law& law = laws_[k];
      const coupled::AtDepth at = law.at(law.abscissa(depth), false);
      const Vec2 push = law.push(at, u);
      rows.col(static_cast<Eigen::Index>(k)) << -push.x, -push.y, at.push + law.plain_coupling(at, u);
    }
    return rows;
  }

private:
  const CoupledScales& scales_;
  std::vector<Law> laws_;
};

/// CoupledRows of forces over the peak, data first, priors after; the limit's columns stay empty.
struct CoupledRows {
  MatrixXd matrix;
  VectorXd target;
};

CoupledRows make_rows(const PairSamples& data, const CoupledScales& scales) {
  const Degrees& d = scales.degrees;
  const coupled::Places p = coupled::places(d);
  const Columns columns(scales);
  std::vector<RowVectorXd> rows;
  std::vector<double> target;
  const auto add = [&](const RowVectorXd& row, double value) {
    rows.push_back(row.head(p.limit));
    target.push_back(value);
  };
  for (const auto* list : {&data.normal, &data.tangential}) {
    for (const Sample* s : *list) {
      const double trust = 1 / std::hypot(1.0, s->error_estimate / kUsualError);
      const double w = trust * data.weight(*s);
      const auto at = columns.rows(s->deflection.z(), scaled(s->deflection, scales.sideways));
      for (int axis = 0; axis < 3; ++axis) add(w * data.peak * at.row(axis), w * s->force[axis]);
    }
  }
  // Beyond the deepest sample the straight push goes on with its stiffness there.
  const double deepest = data.normal.back()->deflection.z(), step = 1e-4 * deepest;
  for (int k = 1; k <= kContinuationPoints && deepest < scales.depth * (1 - 1e-9); ++k) {
    const double z = deepest + (scales.depth - deepest) * k / kContinuationPoints, run = (z - deepest) / step;
    const auto there = columns.rows(z, {}), here = columns.rows(deepest, {}), before = columns.rows(deepest - step, {});
    for (int axis = 0; axis < 3; ++axis) {
      add(kContinuation * (there.row(axis) - here.row(axis) - run * (here.row(axis) - before.row(axis))), 0);
    }
  }
  const auto bend = [&](int place, int components, int terms) {
    for (int c = 0; c < components; ++c) {
      for (int k = 1; k + 1 < terms; ++k) {
        RowVectorXd row = RowVectorXd::Zero(p.end);
        row[place + components * (k - 1) + c] = row[place + components * (k + 1) + c] = kBend;
        row[place + components * k + c] = -2 * kBend;
        add(row, 0);
      }
    }
  };
  bend(0, 1, d.push - 1);
  bend(p.straight, 2, d.straight - 1);
  bend(p.stiffness, 3, d.stiffness + 1);
  bend(p.coupling, 3, coupled::from_square(d.stiffness));
  for (int k = 0; k < p.limit; ++k) add(kRidge * RowVectorXd::Unit(p.end, k), 0);
  CoupledRows result{MatrixXd(static_cast<Eigen::Index>(rows.size()), p.limit),
                     VectorXd(static_cast<Eigen::Index>(rows.size()))};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    result.matrix.row(static_cast<Eigen::Index>(k)) = rows[k];
    result.target[static_cast<Eigen::Index>(k)] = target[k];
  }
  return result;
}

/// What broken_rule asks of a law, but for the limit: unknowns are its coefficients, then a bound of each length that
/// margin sums up.
class Rules {
public:
  explicit Rules(const Degrees& degrees) : d_(degrees), p_(coupled::places(degrees)), unknowns_(p_.limit) {
    for (Index k = 0; k < p_.straight; ++k) {
      if (k == 0) cones_.push_back({{k}, MatrixXd::Ones(1, 1)});
      if (k > 0) cones_.push_back({{k - 1, k}, Eigen::RowVector2d(-1, 1)});
    }
    for (int i = 0; i <= d_.stiffness; ++i) {
      const std::vector<Bound> bounds = bound_lengths(i);
      for (const int sign : i < 2 ? std::vector{1} : std::vector{1, -1}) add_passive(i, sign, bounds);
    }
  }

  [[nodiscard]] const std::vector<Cone>& cones() const { return cones_; }

  /// Inside all of them: no C and Q, no A, and what of F and K' lies outside is pushed in.
  [[nodiscard]] VectorXd start(const VectorXd& coefs) const {
    constexpr double kInside = 1e-3;
    VectorXd x = VectorXd::Zero(unknowns_);
    x.head(p_.coupling) = coefs.head(p_.coupling);
    double last = 0;
    for (int k = 0; k < p_.straight; ++k) last = x[k] = std::max(coefs[k], last + kInside);
    for (int i = 0; i <= d_.stiffness; ++i) {
      auto k = x.segment<3>(p_.stiffness + 3 * i);
      k[0] = std::max(k[0], std::hypot(k[1], k[2]) + kInside);
    }
    x.tail(unknowns_ - p_.limit).setConstant(kInside / 100);  // the factors sum up to 48 at most
    return x;
  }

private:
  /// Of an unknown, and how many times margin has it.
  struct Bound {
    Index at;
    double factor;
  };

  /// The lengths of margin(i) below unknowns of their own.
  std::vector<Bound> bound_lengths(int i) {
    std::vector<Bound> bounds;
    coupled::for_each_harmonic(d_, [&](const coupled::Harmonic& h) {
      Cone cone;
      cone.rows = MatrixXd::Zero(1 + h.parts, 1 + h.parts * (h.degree + 1));
      cone.of.push_back(unknowns_++);
      cone.rows(0, 0) = 1;
      for (int j = 0; j <= h.degree; ++j) {
        const VectorXd unit = VectorXd::Unit(h.degree + 1, j);
        const double share = coupled::raised(unit.data(), 1, 0, h.degree, d_.stiffness, i);
        for (int part = 0; part < h.parts; ++part) {
          cone.rows(1 + part, static_cast<Index>(cone.of.size())) = share;
          cone.of.push_back(h.place + h.components * j + h.first + part);
        }
      }
      bounds.push_back({cone.of.front(), h.factor});
      cones_.push_back(std::move(cone));
    });
    return bounds;
  }

  /// The smallest eigenvalue of K' + sign A above the bounds.
  void add_passive(int i, int sign, const std::vector<Bound>& bounds) {
    const bool coupled = i >= 2;
    Cone cone;
    cone.rows = MatrixXd::Zero(3, (coupled ? 6 : 3) + static_cast<Index>(bounds.size()));
    for (int c = 0; c < 3; ++c) cone.of.push_back(p_.stiffness + 3 * i + c);
    cone.rows.leftCols<3>().setIdentity();
    for (int c = 0; coupled && c < 3; ++c) cone.of.push_back(p_.coupling + 3 * (i - 2) + c);
    if (coupled) cone.rows.middleCols<3>(3) = sign * Eigen::Matrix3d::Identity();
    for (const Bound& bound : bounds) {
      cone.rows(0, static_cast<Index>(cone.of.size())) = -bound.factor;
      cone.of.push_back(bound.at);
    }
    cones_.push_back(std::move(cone));
  }

  Degrees d_;
  coupled::Places p_;
  Index unknowns_;
  std::vector<Cone> cones_;
};

}  // namespace

Law make_law(const VectorXd& coefs, const CoupledScales& scales) {
  coupled::Blend blend;
  blend.clear(scales.degrees);
  blend.add(coefs.data(), 1, 1, 1);
  Law law;
  law.set(blend, scales.depth, scales.sideways);
  return law;
}

Eigen::Vector3d evaluate(const Law& law, const CoupledScales& scales, const Eigen::Vector2d& sideways, double depth) {
  if (!(depth > 0)) return Eigen::Vector3d::Zero();
  const coupled::AtDepth at = law.at(law.abscissa(depth), false);
  const Vec2 u{sideways.x() / scales.sideways, sideways.y() / scales.sideways}, push = law.push(at, u);
  return {-push.x, -push.y, at.push + law.coupling(at, u)};
}

Eigen::Vector3d evaluate(const Law& law, const CoupledScales& scales, const Eigen::Vector3d& deflection) {
  return evaluate(law, scales, Eigen::Vector2d(deflection.head<2>()), deflection.z());
}

Eigen::Vector2d deepened(const Law& law, const CoupledScales& scales, double from, double to,
                         const Eigen::Vector2d& sideways) {
  const Vec2 u{sideways.x() / scales.sideways, sideways.y() / scales.sideways};
  const Vec2 kept = law.deepen(law.abscissa(from), law.abscissa(to), u);
  return scales.sideways * Eigen::Vector2d(kept.x, kept.y);
}

VectorXd fit_limit(const std::vector<Sample>& samples, const CoupledScales& scales, double relief,
                   const std::string& what) {
  const int n = scales.degrees.limit + 1;
  const coupled::Places p = coupled::places(scales.degrees);
  const std::vector<std::pair<double, double>> limits = friction_limits(samples, scales.depth, relief);
  const auto count = static_cast<Eigen::Index>(limits.size());
  MatrixXd matrix = MatrixXd::Zero(count + n - 1, n);
  VectorXd target = VectorXd::Zero(matrix.rows());
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& [depth, limit] = limits[static_cast<std::size_t>(i)];
    target[i] = limit;
    for (int k = 0; k < n; ++k) {
      const Law law = make_law(VectorXd::Unit(p.end, p.limit + k), scales);
      matrix(i, k) = law.at(law.abscissa(depth), false).limit;
    }
  }
  for (int k = 0; k + 1 < n; ++k) {  // constant where nothing says otherwise
    matrix(count + k, k) = -kContinuation;
    matrix(count + k, k + 1) = kContinuation;
  }
  return solve_nonnegative(matrix, target, what + ", friction limit");
}

VectorXd fit_coupled(const std::vector<Sample>& samples, const CoupledScales& scales, const std::string& what) {
  const PairSamples data = sort_samples(samples, what);
  const coupled::Places p = coupled::places(scales.degrees);
  const CoupledRows rows = make_rows(data, scales);
  VectorXd coefs = VectorXd::Zero(p.end);
  coefs.head(p.limit) = solve_linear(rows.matrix, rows.target, what + ", coupled law");
  if (coupled::broken_rule(coefs.data(), scales.degrees, HUGE_VAL) != nullptr) {
    const Rules rules(scales.degrees);
    coefs.head(p.limit) =
        solve_in_cones(rows.matrix, rows.target, rules.cones(), rules.start(coefs), what + ", coupled law")
            .head(p.limit);
  }
  coefs.head(p.limit) *= data.peak;
  coefs.tail(p.end - p.limit) = fit_limit(samples, scales, 0, what);
  return coefs;
}

namespace {

// Empty where what the inequalities add to a rounded mean leaves no room in `bits`.
std::optional<Quantised> quantise(const VectorXd& coefs, const Degrees& degrees, int bits, double largest) {
  const coupled::Places p = coupled::places(degrees);
  Quantised result;
  result.unit = static_cast<float>(coefs.head(p.limit).cwiseAbs().maxCoeff() / largest);
  std::vector<double> whole(static_cast<std::size_t>(p.end));
  for (int k = 0; k < p.end; ++k) {
    whole[static_cast<std::size_t>(k)] =
        std::round(coefs[k] / (k < p.limit ? static_cast<double>(result.unit) : layout::kLimitUnit));
  }
  for (int i = 0; i <= degrees.stiffness; ++i) {
    const double slack = std::min(coupled::passive_slack(whole.data(), degrees, i, 1),
                                  coupled::passive_slack(whole.data(), degrees, i, -1));
    if (slack < 0) whole[static_cast<std::size_t>(p.stiffness + 3 * i)] += std::ceil(-slack);
  }
  for (int k = 0; k < p.end; ++k) {
    const double value = whole[static_cast<std::size_t>(k)];
    if (!(std::abs(value) < (k < p.limit ? std::exp2(bits - 1) : 32768))) return std::nullopt;
    result.coefs.push_back(static_cast<std::int16_t>(value));
  }
  return result;
}

}  // namespace

Quantised quantise(const VectorXd& coefs, const Degrees& degrees, int bits, const std::string& what) {
  // What the inequalities add has room above most times; where it has not, units are larger.
  for (double largest = 0.9765625 * std::exp2(bits - 1); largest > 1; largest *= 0.9) {
    if (auto result = quantise(coefs, degrees, bits, largest)) return *result;
  }
  throw Error(ExitCode::numerical, what + ": a coefficient is out of range");
}

VectorXd rounded(const VectorXd& coefs, const Degrees& degrees, int bits, const std::string& what) {
  const Quantised q = quantise(coefs, degrees, bits, what);
  const int limit = coupled::places(degrees).limit;
  VectorXd result(coefs.size());
  for (Eigen::Index k = 0; k < result.size(); ++k) {
    result[k] = q.coefs[static_cast<std::size_t>(k)] * (k < limit ? static_cast<double>(q.unit) : layout::kLimitUnit);
  }
  return result;
}

}  // namespace palpate::fit
