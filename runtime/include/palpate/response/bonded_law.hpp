// SPDX-License-Identifier: MIT
// Force and torque of a bonded contact, which neither slips nor separates: the gradient of a stored energy.
#pragma once

#include "palpate/format/bonded_rules.hpp"
#include "palpate/format/full_turn.hpp"
#include "palpate/format/spline.hpp"
#include "palpate/math/vec2.hpp"
#include "palpate/math/vec3.hpp"

#include <cmath>

/// Vec3 stands for the components (x, y, n) here: x and y across the normal, n along it. n of a deflection is the depth
/// z, negative while the tool pulls.
///
///     W = integral of Fn dz - Fx x - Fy y + e . k e / 2            e = (x, y)
///         - T . u + e . C u + v . K v / 2                          u = o theta / a, v = r theta / a, a = |theta|
///
///     z, e   deflection of the tool's point p from c (m)           theta  rotation vector of the tool about p (rad)
///     F      force without deflection across the normal (N)        T      torque without rotation (N m)
///     k, K   stiffness of translation (N/m), rotation (N m)        C      coupling, deflection by rotation (N)
///
///     o = r = a up to 1 rad; beyond, with t = (a - 1) / M and M = pi - 1,
///     o = 1 + M t - (1 + M) t^2,          r = 1 + M (t - t^2 / 2)
///
/// F, k, T, K and C are cubic splines over z from -L to L, L = layout::kBondedRange Z. F and T continue linearly
/// beyond, the others keep their values. The force on the tool is (-dW/dx, -dW/dy, dW/dz).
///
/// At a = pi theta and -theta are one rotation, and there o = 0 and r has no slope. So W depends on the pose alone and
/// has a continuous gradient. The torque on the tool about p is -J(theta)^-T dW/dtheta, with J the left Jacobian of
/// SO(3) (Sola, Deray and Atchuthan 2018, equations 145 and 146). A closed motion does no work. 0 <= o <= r keeps the
/// lower bound of W that the file guarantees.
namespace palpate::runtime {

namespace detail {

/// kCount splines of the depth. Fixed size; nothing is allocated.
template <int kCount>
class BondedCurves {
public:
  struct AtDepth {
    double value[kCount], slope[kCount];  ///< slope: by the depth
  };

  /// Sets all curves to zero. `count`: coefficients of a curve, 4 to 32. `depth_scale`: Z (m).
  void clear(int count, double depth_scale) {
    count_ = count;
    range_ = layout::kBondedRange * depth_scale;
    for (int i = 0; i < kCount * count; ++i) coefs_[i] = 0;
  }

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] double range() const { return range_; }  ///< m, L
  [[nodiscard]] const double* coefs() const { return coefs_; }
  [[nodiscard]] double* coefs() { return coefs_; }

  [[nodiscard]] AtDepth at(double z) const {
    const double u = 0.5 * (z / range_ + 1), inside = u > 0 ? (u < 1 ? u : 1) : 0;
    const spline::Basis value = spline::basis(count_, inside), slope = spline::slope_basis(count_, inside);
    AtDepth r;
    for (int k = 0; k < kCount; ++k) {
      const double* curve = coefs_ + k * count_;
      const double rise = spline::combine(slope, curve);
      r.value[k] = spline::combine(value, curve) + (k < 3 ? (u - inside) * rise : 0);
      r.slope[k] = 0.5 * rise / range_;
    }
    return r;
  }

private:
  int count_ = 0;
  double range_ = 1;
  double coefs_[kCount * layout::kMaxCoefs] = {};
};

/// Adds coefficient i of a response's curves with a weight, rotated by the complex number `axis`.
template <class Scalar>
struct RotatedSum {
  const Scalar* from;
  double* to;
  int count, i;
  double weight;
  Vec2 axis;

  [[nodiscard]] double get(int curve) const { return weight * static_cast<double>(from[curve * count + i]); }
  void add(int curve, double value) const { to[curve * count + i] += value; }
  void scalar(int n) const { add(n, get(n)); }
  void vector(int x, int y) const {
    const Vec2 v = product({get(x), get(y)}, axis);
    add(x, v.x);
    add(y, v.y);
  }
  /// A tensor is its mean, its skew part and a second harmonic, which rotates by twice the angle. Symmetric: xy == yx.
  void tensor(int xx, int xy, int yx, int yy) const {
    const double mean = 0.5 * (get(xx) + get(yy)), skew = 0.5 * (get(xy) - get(yx));
    const Vec2 h = product({0.5 * (get(xx) - get(yy)), 0.5 * (get(xy) + get(yx))}, product(axis, axis));
    add(xx, mean + h.x);
    add(xy, h.y + skew);
    if (yx != xy) add(yx, h.y - skew);
    add(yy, mean - h.x);
  }
};

/// u = odd theta and v = even theta at an angle a in [0, pi]. A slope is (d(scale a)/da - scale) / a^2.
struct RotationScales {
  double odd = 1, even = 1, odd_slope = 0, even_slope = 0;

  explicit RotationScales(double a) {
    if (!(a > layout::kMaxRotation)) return;
    constexpr double kRest = 0.5 * kFullTurn - layout::kMaxRotation;
    const double t = (a - layout::kMaxRotation) / kRest;
    even = (1 + kRest * (t - 0.5 * t * t)) / a;
    odd = (1 + kRest * t - (1 + kRest) * t * t) / a;
    even_slope = (1 - t - even) / (a * a);
    odd_slope = (1 - 2 * (1 + kRest) / kRest * t - odd) / (a * a);
  }
};

/// J(theta)^-T g = g + theta x g / 2 + (1 - (a / 2) cot(a / 2)) / a^2 theta x (theta x g), a = |theta| at most pi.
inline Vec3 per_angular_velocity(const Vec3& theta, const Vec3& g) {
  const double squared = dot(theta, theta), half = 0.5 * std::sqrt(squared);
  const double c = squared > 1e-4 ? (1 - half * std::cos(half) / std::sin(half)) / squared : 1.0 / 12 + squared / 720;
  const Vec3 once = cross(theta, g);
  return g + 0.5 * once + c * cross(theta, once);
}

}  // namespace detail

/// Force of a bonded contact: the first line of W, of one response or of a blend.
class BondedLaw : public detail::BondedCurves<static_cast<int>(layout::kBondedCurves)> {
public:
  /// Adds a response's curves (Fx, Fy, Fn, kxx, kxy, kyy) with a weight. `axis`: the response's x axis in this law's
  /// basis, as a unit complex number.
  template <class Scalar>
  void add(const Scalar* curves, double weight, const Vec2& axis = {1, 0}) {
    for (int i = 0; i < count(); ++i) {
      const detail::RotatedSum<Scalar> sum{curves, coefs(), count(), i, weight, axis};
      sum.vector(0, 1);
      sum.scalar(2);
      sum.tensor(3, 4, 4, 5);
    }
  }

  /// Returns the force on the tool (N) at a deflection (m).
  [[nodiscard]] Vec3 force(const Vec3& d) const { return force(at(d.z), d.x, d.y); }
  [[nodiscard]] static Vec3 force(const AtDepth& r, double x, double y) {
    const double *f = r.value, *slope = r.slope;
    return {f[0] - f[3] * x - f[4] * y, f[1] - f[4] * x - f[5] * y,
            f[2] - slope[0] * x - slope[1] * y + 0.5 * (slope[3] * x * x + 2 * slope[4] * x * y + slope[5] * y * y)};
  }

  /// Sets the deflection at which the force (N) is `force`. Returns false where none exists with a depth in [-L, L].
  [[nodiscard]] bool find(const Vec3& force, Vec3& deflection) const {
    return find_depth(range(), [&](double z) {
      const AtDepth r = at(z);
      const double xx = r.value[3], xy = r.value[4], yy = r.value[5], determinant = xx * yy - xy * xy;
      const double x = r.value[0] - force.x, y = r.value[1] - force.y;
      if (!(determinant > 1e-9 * (xx + yy) * (xx + yy))) return std::nan("");
      deflection = {(yy * x - xy * y) / determinant, (xx * y - xy * x) / determinant, z};
      return BondedLaw::force(r, deflection.x, deflection.y).z - force.z;
    });
  }

  /// Bisects for the depth in [-range, range] at which `excess` becomes at least 0, and ends with a call there. Returns
  /// false without excess(-range) < 0 <= excess(range), and where `excess` is not a number.
  template <class Excess>
  [[nodiscard]] static bool find_depth(double range, const Excess& excess) {
    constexpr int kSteps = 60;  // to the rounding of a double
    double low = -range, high = range;
    if (!(excess(low) < 0 && excess(high) >= 0)) return false;
    for (int i = 0; i < kSteps; ++i) {
      const double middle = 0.5 * (low + high);
      (excess(middle) < 0 ? low : high) = middle;
    }
    return excess(high) >= 0;
  }
};

/// Force (N) and torque (N m) on the tool, in components.
struct BondedWrench {
  Vec3 force, torque;
};

/// Force and torque of a bonded contact: the second line of W. A BondedLaw of the same responses has the first.
class BondedTorqueLaw : public detail::BondedCurves<static_cast<int>(layout::kTorqueCurves)> {
public:
  /// Adds a response's curves (layout::kTorqueCurves) as BondedLaw::add does.
  template <class Scalar>
  void add(const Scalar* curves, double weight, const Vec2& axis = {1, 0}) {
    for (int i = 0; i < count(); ++i) {
      const detail::RotatedSum<Scalar> sum{curves, coefs(), count(), i, weight, axis};
      sum.vector(0, 1);  // T
      sum.scalar(2);
      sum.tensor(3, 4, 4, 5);  // K
      sum.vector(6, 7);
      sum.scalar(8);
      sum.tensor(9, 10, 12, 13);  // C
      sum.vector(11, 14);
    }
  }

  /// Returns the wrench about p at a deflection (m) and a rotation vector (rad, length at most pi).
  [[nodiscard]] BondedWrench wrench(const BondedLaw& law, const Vec3& d, const Vec3& theta) const {
    const auto r = at(d.z);
    const detail::RotationScales scales(length(theta));
    const Vec3 u = scales.odd * theta, v = scales.even * theta;
    const Vec3 load = odd(r.value, d.x, d.y), bent = even(r.value, v);
    const double* c = r.value + 9;
    Vec3 force = law.force(d);
    force.x -= c[0] * u.x + c[1] * u.y + c[2] * u.z;
    force.y -= c[3] * u.x + c[4] * u.y + c[5] * u.z;
    force.z += dot(odd(r.slope, d.x, d.y), u) + 0.5 * dot(even(r.slope, v), v);
    const double along = scales.odd_slope * dot(theta, load) + scales.even_slope * dot(theta, bent);
    const Vec3 gradient = scales.odd * load + scales.even * bent + along * theta;
    return {force, -detail::per_angular_velocity(theta, gradient)};
  }

  /// Sets the deflection and the rotation at which the force is `force` (N) and the torque is zero. Returns false where
  /// none exist with a depth in [-L, L] and an angle up to layout::kMaxRotation.
  [[nodiscard]] bool find(const BondedLaw& law, const Vec3& force, Vec3& d, Vec3& theta) const {
    const bool found = BondedLaw::find_depth(law.range(), [&](double z) {
      const auto moved = law.at(z);
      const auto r = at(z);
      double m[5][6] = {};
      bonded::stiffness(moved.value + 3, r.value + 3, m);
      for (int i = 0; i < 5; ++i) m[i][5] = i < 2 ? moved.value[i] - (i == 0 ? force.x : force.y) : r.value[i - 2];
      if (!bonded::solve_positive(m)) return std::nan("");
      d = {m[0][5], m[1][5], z};
      theta = {m[2][5], m[3][5], m[4][5]};
      return BondedLaw::force(moved, d.x, d.y).z + dot(odd(r.slope, d.x, d.y), theta) +
             0.5 * dot(even(r.slope, theta), theta) - force.z;
    });
    return found && dot(theta, theta) <= layout::kMaxRotation * layout::kMaxRotation;
  }

private:
  /// C^T e - T: factor of u in W.
  [[nodiscard]] static Vec3 odd(const double* t, double x, double y) {
    return {t[9] * x + t[12] * y - t[0], t[10] * x + t[13] * y - t[1], t[11] * x + t[14] * y - t[2]};
  }
  /// K v.
  [[nodiscard]] static Vec3 even(const double* t, const Vec3& v) {
    return {t[3] * v.x + t[4] * v.y + t[6] * v.z, t[4] * v.x + t[5] * v.y + t[7] * v.z,
            t[6] * v.x + t[7] * v.y + t[8] * v.z};
  }
};

}  // namespace palpate::runtime
