// SPDX-License-Identifier: GPL-3.0-or-later
// CoupledRows from the runtime's own law, a first solution without constraints, and cones by their square roots.
#include "precompute/fit/coupled_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "formats/error.hpp"
#include "palpate/coupled_check.hpp"
#include "palpate/response_layout.hpp"
#include "precompute/fit/friction_limit.hpp"
#include "precompute/fit/least_squares.hpp"
#include "precompute/fit/pair_samples.hpp"

namespace palpate::fit {
namespace {

using coupled::Degrees;
using coupled::Law;
using coupled::Vec2;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

// Errors estimated above this count less: those of shallow contacts of few integration points.
constexpr double kUsualError = 0.05;
// Weak against data (relative errors): they decide only where no data do.
constexpr double kRidge = 1e-6, kBend = 2e-4, kContinuation = 0.02;
constexpr int kContinuationPoints = 6;
// Of the peak; keeps sums of lengths differentiable and cones apart from their tips.
constexpr double kTip = 1e-7;

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

/// The coefficients from parameters that may be anything: increments of F by squares, K' +- A by Cholesky factors above
/// the margin of C and Q, the rest as it is.
class Cones {
public:
  explicit Cones(const Degrees& degrees) : d_(degrees), p_(coupled::places(degrees)) {}
  [[nodiscard]] int parameters() const { return p_.limit; }  // K', A and their factors are as many

  [[nodiscard]] VectorXd start(const VectorXd& coefs) const {
    VectorXd p = coefs.head(p_.limit);
    double last = 0;
    for (int k = 0; k < p_.straight; ++k) {
      p[k] = std::sqrt(std::max(coefs[k] - last, 1e-4));
      last = std::max(last, coefs[k]);
    }
    for (int i = 0; i <= d_.stiffness; ++i) {
      const Eigen::Vector3d k = coefs.segment<3>(p_.stiffness + 3 * i);
      const Eigen::Vector3d a = i < 2 ? Eigen::Vector3d::Zero() : Eigen::Vector3d(coefs.segment<3>(coupling(i)));
      const double least = coupled::margin(coefs.data(), d_, i);
      p.segment<3>(p_.stiffness + 3 * i) = root(k + a, least);
      if (i >= 2) p.segment<3>(coupling(i)) = root(k - a, least);
    }
    return p;
  }

  void map(const VectorXd& p, VectorXd& c, MatrixXd& slope) const {
    c = p;
    slope.setIdentity(p.size(), p.size());
    double sum = 0;
    for (int k = 0; k < p_.straight; ++k) {
      c[k] = sum += p[k] * p[k];
      for (int j = 0; j <= k; ++j) slope(k, j) = 2 * p[j];
    }
    for (int i = 0; i <= d_.stiffness; ++i) {
      RowVectorXd rise = RowVectorXd::Zero(p.size());
      const double least = smooth_margin(p, i, rise);
      const int at = p_.stiffness + 3 * i, other = i < 2 ? at : coupling(i);
      Eigen::Vector3d plus, minus;
      Eigen::Matrix3d dplus, dminus;
      square(p.segment<3>(at), plus, dplus);
      square(p.segment<3>(other), minus, dminus);
      c.segment<3>(at) = 0.5 * (plus + minus);
      c[at] += least;
      slope.block<3, 3>(at, at).setZero();
      slope.block<3, 3>(at, at) += 0.5 * dplus;
      if (i < 2) {
        slope.block<3, 3>(at, at) += 0.5 * dminus;
      } else {
        c.segment<3>(other) = 0.5 * (plus - minus);
        slope.block<3, 3>(at, other) = 0.5 * dminus;
        slope.block<3, 3>(other, at) = 0.5 * dplus;
        slope.block<3, 3>(other, other) = -0.5 * dminus;
      }
      slope.row(at) += rise;
    }
  }

private:
  [[nodiscard]] int coupling(int i) const { return p_.coupling + 3 * (i - 2); }

  /// (mean, second harmonic) of L L' and its derivatives; q = L's diagonal and off-diagonal.
  static void square(const Eigen::Vector3d& q, Eigen::Vector3d& k, Eigen::Matrix3d& slope) {
    const double a = q[0], b = q[1], c = q[2];  // L = [a 0; c b]
    k << 0.5 * (a * a + c * c + b * b), 0.5 * (a * a - c * c - b * b), a * c;
    slope << a, b, c, a, -b, -c, c, 0, a;
  }
  /// Such a q for k less `least`, pushed into the cone where it is not.
  static Eigen::Vector3d root(const Eigen::Vector3d& k, double least) {
    const double size = std::hypot(k[1], k[2]), mean = std::max(k[0] - least, size + 1e-3 * (size + 1e-2));
    const double a = std::sqrt(mean + k[1]), c = k[2] / a;
    return {a, std::sqrt(std::max(mean - k[1] - c * c, 1e-12)), c};
  }

  /// coupled::margin and its derivative, a little above it where a length is near 0.
  double smooth_margin(const VectorXd& p, int i, RowVectorXd& rise) const {
    double sum = 0;
    const auto add = [&](double factor, int place, int components, int first, int parts, int degree) {
      Eigen::Vector2d h = Eigen::Vector2d::Zero();
      for (int part = 0; part < parts; ++part) {
        h[part] = coupled::raised(p.data() + place, components, first + part, degree, d_.stiffness, i);
      }
      const double size = std::hypot(h.norm(), kTip);
      sum += factor * size;
      for (int j = 0; j <= degree; ++j) {
        VectorXd unit = VectorXd::Zero(degree + 1);
        unit[j] = 1;
        const double share = coupled::raised(unit.data(), 1, 0, degree, d_.stiffness, i);
        for (int part = 0; part < parts; ++part) {
          rise[place + components * j + first + part] += factor * share * h[part] / size;
        }
      }
    };
    if (d_.order > 2) {
      add(6, p_.cubic, 4, 0, 2, d_.cubic);
      add(6, p_.cubic, 4, 2, 2, d_.cubic);
    }
    if (d_.order > 3) {
      add(12, p_.quartic, 5, 0, 1, d_.quartic);
      add(12, p_.quartic, 5, 1, 2, d_.quartic);
      add(12, p_.quartic, 5, 3, 2, d_.quartic);
    }
    return sum;
  }

  Degrees d_;
  coupled::Places p_;
};

VectorXd fit_limit(const std::vector<Sample>& samples, const CoupledScales& scales, const std::string& what) {
  const int n = scales.degrees.limit + 1;
  const coupled::Places p = coupled::places(scales.degrees);
  const std::vector<std::pair<double, double>> limits = friction_limits(samples);
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

}  // namespace

Law make_law(const VectorXd& coefs, const CoupledScales& scales) {
  Law law;
  law.clear(scales.degrees, scales.depth, scales.sideways);
  law.add(coefs.data(), 1, 1, 1);
  law.finish();
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

VectorXd fit_coupled(const std::vector<Sample>& samples, const CoupledScales& scales, const std::string& what) {
  const PairSamples data = sort_samples(samples, what);
  const coupled::Places p = coupled::places(scales.degrees);
  const CoupledRows rows = make_rows(data, scales);
  VectorXd coefs = VectorXd::Zero(p.end);
  coefs.head(p.limit) = solve_linear(rows.matrix, rows.target, what + ", coupled law");
  if (coupled::broken_rule(coefs.data(), scales.degrees, HUGE_VAL) != nullptr) {
    const Cones cones(scales.degrees);
    VectorXd parameters = cones.start(coefs);
    const CoefficientMap map = [&](const VectorXd& q, VectorXd& c, MatrixXd& slope) { cones.map(q, c, slope); };
    solve_mapped(rows.matrix, rows.target, map, parameters, what + ", coupled law");
    VectorXd c(p.limit);
    MatrixXd slope(p.limit, p.limit);
    cones.map(parameters, c, slope);
    coefs.head(p.limit) = c;
  }
  coefs.head(p.limit) *= data.peak;
  coefs.tail(p.end - p.limit) = fit_limit(samples, scales, what);
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
