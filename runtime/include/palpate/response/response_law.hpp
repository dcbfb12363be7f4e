// SPDX-License-Identifier: MIT
// The quadratic response law: force of one response, or of a blend of several, as a function of depth and deflection.
#pragma once

#include "palpate/format/response_coefficients.hpp"
#include "palpate/math/vec2.hpp"

#include <cmath>

namespace palpate::runtime {

/// A normal indentation to one depth z.
struct NormalResponse {
  double normal_force = 0;    ///< F (N)
  double normal_slope = 0;    ///< dF/dz (N/m)
  double work = 0;            ///< W (J): integral of F from the surface to z
};

/// Everything of a response at one depth z. Vectors and tensors are in the response's basis across the normal.
struct ResponseAtDepth : NormalResponse {
  Vec2 bias, bias_slope;      ///< g (N), dg/dz (N/m): tangential push of the hand in a normal indentation
  Sym2 stiffness;             ///< K (N/m): tangential stiffness
  Sym2 normal_coupling;       ///< A (N/m^2): the normal force has the part e . A e / 2
  double friction_coefficient = 0;  ///< mu: tangential over normal force at gross slip
};

/// With s = sqrt(z / Z), every family is a polynomial in s:
///
///     F(s), g(s) from s^2 on,    K(s) the integral of K' from 0,    A(s) from s^2 on,    mu(s).
///
/// Deeper than Z, F, g and K go on linearly in z with their slopes at Z; A, mu, dg/dz keep their values there.
/// A sticking contact with the tangential deflection e (m) stores
///
///     E(e, z) = W(z) + g(z) . e + e . K(z) e / 2,
///
/// the hand pushes with g + K e across the normal, and the normal force is F + dg/dz . e + e . A e / 2. The file
/// guarantees -dK/dz <= A <= dK/dz, so that a lift gives back no more than E holds. Evaluation is const and allocates
/// nothing.
class ResponseLaw {
public:
  /// From coefficients in the file's order and Bernstein basis, in N (mu without unit). Z and X in m; X = 0 without
  /// friction.
  void set(const response::Degrees& degrees, const double* coefs, double depth_scale, double tangential_scale) {
    depth_scale_ = depth_scale;
    degrees_ = degrees;
    const double per_depth = 1 / depth_scale, per_tangential = tangential_scale > 0 ? 1 / tangential_scale : 0;
    to_powers<1>(coefs, 2, degrees.normal, 1, normal_);
    coefs += response::from_square(degrees.normal);
    if (degrees.bias > 0) {
      to_powers<2>(coefs, 2, degrees.bias, 1, bias_);
      coefs += 2 * response::from_square(degrees.bias);
    }
    if (!degrees.friction_families) return;
    to_powers<3>(coefs, 0, degrees.stiffness, per_tangential, stiffness_);
    coefs += 3 * (degrees.stiffness + 1);
    for (int k = 0; k <= degrees.stiffness; ++k) {  // K = integral of K'
      for (double& each : stiffness_[k]) each /= k + 1;
    }
    if (degrees.stiffness > 0) {
      to_powers<3>(coefs, 2, degrees.stiffness, 0.5 * per_tangential * per_depth, coupling_);
      coefs += 3 * response::from_square(degrees.stiffness);
    }
    to_powers<1>(coefs, 0, degrees.friction, 1, friction_);
  }

  /// Goes towards another law of the same file by a share in [0, 1].
  void mix(const ResponseLaw& other, double share) {
    mix(other.normal_, share, normal_);
    mix(other.bias_, share, bias_);
    mix(other.stiffness_, share, stiffness_);
    mix(other.coupling_, share, coupling_);
    mix(other.friction_, share, friction_);
  }

  [[nodiscard]] double depth_scale() const { return depth_scale_; }
  /// Whether the law has tangential stiffness and friction.
  [[nodiscard]] bool has_friction() const { return degrees_.friction_families; }

  /// All terms at a depth z > 0 (m).
  [[nodiscard]] ResponseAtDepth at(double z) const {
    ResponseAtDepth r;
    static_cast<NormalResponse&>(r) = normal(z);
    const double s = abscissa(z), further = beyond(z);
    const double per_s = 1 / (2 * depth_scale_ * s);  // ds/dz
    if (degrees_.bias > 0) {
      double value[2], slope[2];
      sum<2>(bias_, degrees_.bias, 2, s, value, slope);
      r.bias_slope = per_s * Vec2{slope[0], slope[1]};
      r.bias = Vec2{value[0], value[1]} + further * r.bias_slope;
    }
    if (!degrees_.friction_families) return r;
    double value[3], slope[3];
    sum<3>(stiffness_, degrees_.stiffness + 1, 1, s, value, slope);
    r.stiffness = Sym2{value[0], value[1], value[2]} + (further * per_s) * Sym2{slope[0], slope[1], slope[2]};
    if (degrees_.stiffness > 0) {
      sum<3>(coupling_, degrees_.stiffness, 2, s, value, slope);
      r.normal_coupling = (1 / s) * Sym2{value[0], value[1], value[2]};
    }
    double mu[1], mu_slope[1];
    sum<1>(friction_, degrees_.friction, 0, s, mu, mu_slope);
    r.friction_coefficient = mu[0];
    return r;
  }

  /// F, dF/dz and W alone, at a depth z > 0.
  [[nodiscard]] NormalResponse normal(double z) const {
    NormalResponse r = normal_within(abscissa(z));
    const double further = beyond(z);
    r.work += further * (r.normal_force + 0.5 * further * r.normal_slope);
    r.normal_force += further * r.normal_slope;
    return r;
  }

  /// The same at an abscissa s = sqrt(z / Z) in [0, 1].
  [[nodiscard]] NormalResponse normal_within(double s) const {
    constexpr double kReciprocal[response::kMaxDegree + 3] = {0,       1,       1.0 / 2, 1.0 / 3, 1.0 / 4,
                                                              1.0 / 5, 1.0 / 6, 1.0 / 7, 1.0 / 8};
    // F = s^2 p(s), so dF/dz = F'(s) / (2 Z s) = (2 p + s p') / (2 Z). W = integral of F 2 Z s ds: the power k of F
    // gives 2 Z s^(k + 2) / (k + 2).
    double p = 0, slope = 0, work = 0;
    for (int k = degrees_.normal; k >= 2; --k) {
      const double c = normal_[k - 2][0];
      work = work * s + kReciprocal[k + 2] * c;
      slope = slope * s + p;
      p = p * s + c;
    }
    const double squared = s * s, scale = 2 * depth_scale_;
    return {p * squared, (2 * p + s * slope) / scale, work * scale * (squared * squared)};
  }

  /// K (N/m) at an abscissa s = sqrt(z / Z) in [0, 1].
  [[nodiscard]] Sym2 stiffness_at(double s) const {
    Sym2 k;
    for (int i = degrees_.stiffness; i >= 0; --i) {
      const double* c = stiffness_[i];
      k = {(k.m + c[0]) * s, (k.x + c[1]) * s, (k.y + c[2]) * s};
    }
    return k;
  }

private:
  template <int kPowers, int kParts>
  static void mix(const double (&from)[kPowers][kParts], double share, double (&to)[kPowers][kParts]) {
    for (int k = 0; k < kPowers; ++k) {
      for (int c = 0; c < kParts; ++c) to[k][c] += share * (from[k][c] - to[k][c]);
    }
  }

  [[nodiscard]] double abscissa(double z) const { return z < depth_scale_ ? std::sqrt(z / depth_scale_) : 1; }
  /// m, by which z exceeds Z.
  [[nodiscard]] double beyond(double z) const { return z > depth_scale_ ? z - depth_scale_ : 0; }

  /// Coefficients `first` to `degree` of a family of so many parts, from the Bernstein basis to powers of s, times
  /// `scale`: s^first times a polynomial of degree m = degree - first, which is built by
  /// p_j = (1 - s) p_j-1 + binomial(degree, first + j) b_j s^j, p_m at last.
  template <int kParts>
  static void to_powers(const double* from, int first, int degree, double scale, double (*to)[kParts]) {
    for (int j = 0; j <= degree - first; ++j) {
      const double by = scale * response::binomial(degree, first + j);
      for (int c = 0; c < kParts; ++c) to[j][c] = by * from[kParts * j + c];
      for (int i = j; i > 0; --i) {
        for (int c = 0; c < kParts; ++c) to[i][c] -= to[i - 1][c];
      }
    }
  }

  /// Horner's rule: value and derivative by s of the powers `first` to `last`.
  template <int kParts>
  static void sum(const double (*from)[kParts], int last, int first, double s, double (&value)[kParts],
                  double (&slope)[kParts]) {
    for (int c = 0; c < kParts; ++c) value[c] = slope[c] = 0;
    for (int k = last - first; k >= 0; --k) {
      for (int c = 0; c < kParts; ++c) {
        slope[c] = slope[c] * s + value[c];
        value[c] = value[c] * s + from[k][c];
      }
    }
    for (int k = 0; k < first; ++k) {
      for (int c = 0; c < kParts; ++c) {
        slope[c] = slope[c] * s + value[c];
        value[c] *= s;
      }
    }
  }

  response::Degrees degrees_;
  double depth_scale_ = 1;                           ///< Z, m
  double normal_[response::kMaxDegree - 1][1] = {};  ///< N, of s^2, s^3, ...
  double bias_[response::kMaxDegree - 1][2] = {};    ///< N, of s^2, s^3, ...
  double stiffness_[response::kMaxDegree + 1][3] = {};  ///< N/m, of s, s^2, ...
  double coupling_[response::kMaxDegree - 1][3] = {};   ///< N/m^2, of s^2, s^3, ...
  double friction_[response::kMaxDegree + 1][1] = {};   ///< of 1, s, ...
};

}  // namespace palpate::runtime
