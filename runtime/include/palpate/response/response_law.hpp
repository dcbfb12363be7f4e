// SPDX-License-Identifier: MIT
// The quadratic potential of one response or of a blend of responses, evaluated at any depth.
#pragma once

#include "palpate/format/response_layout.hpp"
#include "palpate/math/vec2.hpp"

#include <cmath>

/// With z the depth, t = sqrt(z / Z) up to t = 1 and t = 1 + (z / Z - 1) / 2 beyond, s = min(t, 1), and u = e / X the
/// tangential deflection over X, the stored energy and the forces of the hand are
///
///     W = integral of F dz + X (g . u + u . K u / 2),    T = g + K u,    f_n = F + (X/Z) (g' . u + u . A u / 2) / (2 s),
///
/// K the integral of K' from 0 to s. Beyond Z, F, g and K continue linearly in z, K', A, g' and s keep their values.
namespace palpate::response {

using runtime::Sym2;
using runtime::Vec2;

/// All terms at one depth.
struct AtDepth {
  double s = 0;         ///< min(t, 1)
  double normal = 0;    ///< F (N)
  double friction = 0;  ///< mu
  Vec2 bias;            ///< g (N)
  Vec2 bias_rate;       ///< g' / (2 s) (N)
  Sym2 stiffness;       ///< K (N)
  Sym2 coupling;        ///< A / (2 s) (N)
};

/// A weighted sum of responses in one tangent basis. Fixed size, no allocation.
class Law {
public:
  /// Removes all responses. Depth scale Z and tangential scale X in m.
  void clear(const Degrees& degrees, double depth_scale, double tangential_scale) {
    degrees_ = degrees;
    offsets_ = offsets(degrees);
    depth_scale_ = depth_scale;
    tangential_scale_ = tangential_scale;
    for (double& c : sum_) c = 0;
  }

  /// Adds coefficients with a weight. `unit`: N of one unit; `friction_unit`: that of mu.
  /// `axis`: (cosine, sine) of the angle of the response's x axis in this law's basis.
  template <class Scalar>
  void add(const Scalar* coefs, double unit, double friction_unit, double weight, const Vec2& axis = {1, 0}) {
    const Vec2 first = weight * unit * axis, second = weight * unit * product(axis, axis);
    int at = 0;
    const auto scalar = [&](double by) {
      sum_[at] += by * static_cast<double>(coefs[at]);
      ++at;
    };
    const auto pair = [&](const Vec2& by) {
      const Vec2 h = product({static_cast<double>(coefs[at]), static_cast<double>(coefs[at + 1])}, by);
      sum_[at] += h.x;
      sum_[at + 1] += h.y;
      at += 2;
    };
    while (at < offsets_.bias) scalar(weight * unit);
    while (at < offsets_.stiffness) pair(first);
    while (at < offsets_.friction) {
      scalar(weight * unit);
      pair(second);
    }
    while (at < offsets_.end) scalar(weight * friction_unit);
  }

  [[nodiscard]] const Degrees& degrees() const { return degrees_; }
  /// The sum, coefficient_count(degrees()) coefficients.
  [[nodiscard]] const double* coefficients() const { return sum_; }
  [[nodiscard]] double tangential_scale() const { return tangential_scale_; }

  /// Terms at a depth z > 0 (m).
  [[nodiscard]] AtDepth at(double z) const {
    const double share = z / depth_scale_, s = share < 1 ? std::sqrt(share) : 1;
    const double beyond = share < 1 ? 0 : 0.5 * (share - 1);
    const Degrees& d = degrees_;
    AtDepth terms;
    terms.s = s;
    const Value normal = polynomial(sum_, 1, 2, d.normal, s);
    terms.normal = normal.value + beyond * normal.slope;
    if (d.bias > 0) {
      const Value x = polynomial(sum_ + offsets_.bias, 2, 2, d.bias, s);
      const Value y = polynomial(sum_ + offsets_.bias + 1, 2, 2, d.bias, s);
      terms.bias = {x.value + beyond * x.slope, y.value + beyond * y.slope};
      terms.bias_rate = {x.slope / (2 * s), y.slope / (2 * s)};
    }
    if (!d.has_friction) return terms;
    double k[3], a[3] = {0, 0, 0};
    for (int c = 0; c < 3; ++c) {
      const Value rate = polynomial(sum_ + offsets_.stiffness + c, 3, 0, d.stiffness, s);
      k[c] = rate.integral + beyond * rate.value;
      if (d.stiffness > 0) a[c] = polynomial(sum_ + offsets_.coupling + c, 3, 2, d.stiffness, s).value / (2 * s);
    }
    terms.stiffness = {k[0], k[1], k[2]};
    terms.coupling = {a[0], a[1], a[2]};
    terms.friction = polynomial(sum_ + offsets_.friction, 1, 0, d.friction, s).value;
    return terms;
  }

  /// Tangential force on the tool (N) at a tangential deflection (m).
  [[nodiscard]] Vec2 tangential(const AtDepth& terms, const Vec2& e) const {
    return -1 * (terms.bias + terms.stiffness * scaled(e));
  }
  /// Normal force on the tool (N).
  [[nodiscard]] double normal(const AtDepth& terms, const Vec2& e) const {
    const Vec2 u = scaled(e);
    return terms.normal + tangential_scale_ / depth_scale_ *
                              (dot(terms.bias_rate, u) + 0.5 * quadratic(terms.coupling, u));
  }
  /// The tangential deflection (m) after a deepening from `from` to `to`: K u stays, because new area is unstressed.
  [[nodiscard]] static Vec2 deepened(const AtDepth& from, const AtDepth& to, const Vec2& e) {
    return solve(to.stiffness, from.stiffness * e);
  }

private:
  struct Value {
    double value = 0, slope = 0, integral = 0;
  };
  /// Bernstein's polynomial of which the coefficients from `first` on are stored, every `stride`-th number.
  [[nodiscard]] static Value polynomial(const double* coefs, int stride, int first, int degree, double s) {
    double powers[kMaxDegree + 2], rests[kMaxDegree + 2];
    powers[0] = rests[0] = 1;
    for (int k = 1; k <= degree + 1; ++k) {
      powers[k] = powers[k - 1] * s;
      rests[k] = rests[k - 1] * (1 - s);
    }
    Value sum;
    double running = 0, last = 0;
    for (int k = 0; k <= degree; ++k) {
      const double c = k < first ? 0 : coefs[(k - first) * stride];
      sum.value += c * binomial(degree, k) * powers[k] * rests[degree - k];
      if (k > 0) sum.slope += degree * (c - last) * binomial(degree - 1, k - 1) * powers[k - 1] * rests[degree - k];
      last = c;
      running += c / (degree + 1);
      // The integral has the degree n + 1, and binomial(n + 1, k + 1) = binomial(n, k) (n + 1) / (k + 1).
      sum.integral += running * binomial(degree, k) * (degree + 1) / (k + 1) * powers[k + 1] * rests[degree - k];
    }
    return sum;
  }
  [[nodiscard]] Vec2 scaled(const Vec2& e) const {
    return tangential_scale_ > 0 ? (1 / tangential_scale_) * e : Vec2{};
  }

  Degrees degrees_{};
  Offsets offsets_{};
  double depth_scale_ = 1, tangential_scale_ = 0;
  double sum_[kMaxCoefficients] = {};
};

}  // namespace palpate::response
