// SPDX-License-Identifier: MIT
// The law of a bonded contact whose tool is rotated and translated: force and torque of one energy.
#pragma once

#include "palpate/format/bonded_rules.hpp"
#include "palpate/response/bonded_law.hpp"

#include <cmath>

/// With e = (x, y) and the depth z of p - c, the energy of bonded_law.hpp, and the rotation vector theta of the tool
/// about p (x, y, n; body's axes), the stored energy is
///
///     W = W(e, z) - T(z) . u + e . C(z) u + v . K(z) v / 2,     u = o(a) theta / a, v = r(a) theta / a, a = |theta|.
///
/// Up to a = 1 u and v are theta itself. Beyond, with t = (a - 1) / L and L = pi - 1, r = 1 + L (t - t^2 / 2) and
/// o = 1 + L t - (1 + L) t^2: at a = pi, where theta and -theta are one rotation, r has no slope and o is 0. So W is a
/// function of the pose alone, with a continuous gradient: torques grow no more where they were never sampled, and a
/// turn right round is a closed motion. 0 <= o <= r, hence W keeps the lower bound that the file's inequality gives it.
///
/// The torque on the tool about p is -J(theta)^-T dW/dtheta, with J the left Jacobian of SO(3), which takes the rate of
/// theta to the angular velocity (Sola, Deray and Atchuthan 2018, equations 145 and 146): torque times angular velocity
/// and force times velocity are the rate of -W, so that closed motions do no work.
namespace palpate::bonded {

/// Force (N) and torque (N m) on the tool.
struct Wrench {
  Triple force, torque;
};

inline double dot(const Triple& a, const Triple& b) { return a.x * b.x + a.y * b.y + a.n * b.n; }
inline Triple cross(const Triple& a, const Triple& b) {
  return {a.y * b.n - a.n * b.y, a.n * b.x - a.x * b.n, a.x * b.y - a.y * b.x};
}

/// A vector s theta that depends on theta alone, with what its derivative needs.
struct Stretched {
  double size;   ///< s
  double slope;  ///< of the length by the angle, less s, over the angle squared

  [[nodiscard]] Triple of(const Triple& theta) const { return {size * theta.x, size * theta.y, size * theta.n}; }
  /// Transposed derivative times w.
  [[nodiscard]] Triple pull(const Triple& theta, const Triple& w) const {
    const double along = slope * dot(theta, w);
    return {size * w.x + along * theta.x, size * w.y + along * theta.y, size * w.n + along * theta.n};
  }
};

/// u (odd) and v (even) of an angle a in [0, pi].
struct Stretch {
  Stretched odd{1, 0}, even{1, 0};
  explicit Stretch(double a) {
    if (!(a > layout::kMaxRotation)) return;
    constexpr double kRest = 3.14159265358979323846 - layout::kMaxRotation;
    const double t = (a - layout::kMaxRotation) / kRest;
    even.size = (1 + kRest * (t - 0.5 * t * t)) / a;
    odd.size = (1 + kRest * t - (1 + kRest) * t * t) / a;
    even.slope = (1 - t - even.size) / (a * a);
    odd.slope = (1 - 2 * (1 + kRest) / kRest * t - odd.size) / (a * a);
  }
};

/// J(theta)^-T g = g + theta x g / 2 + (1 - a cot(a / 2) / 2) / a^2 theta x (theta x g); a = |theta| at most pi.
inline Triple per_angular_velocity(const Triple& theta, const Triple& g) {
  const double squared = dot(theta, theta), half = 0.5 * std::sqrt(squared);
  const double c = squared > 1e-4 ? (1 - half * std::cos(half) / std::sin(half)) / squared : 1.0 / 12 + squared / 720;
  const Triple once = cross(theta, g), twice = cross(theta, once);
  return {g.x + 0.5 * once.x + c * twice.x, g.y + 0.5 * once.y + c * twice.y, g.n + 0.5 * once.n + c * twice.n};
}

/// The part of the rotation, of one response or of a blend. Fixed size, no allocation.
class TorqueLaw {
public:
  /// Removes all responses. As Law::clear, with the same count.
  void clear(int count, double depth_scale) { curves_.clear(count, depth_scale); }

  /// Adds a response's curves (T; Kxx, Kxy, Kyy, Kxn, Kyn, Knn; C row by row) as Law::add does.
  template <class Scalar>
  void add(const Scalar* curves, double weight, double cosine = 1, double sine = 0) {
    const int n = curves_.count();
    const double c = cosine, s = sine;
    for (int i = 0; i < n; ++i) {
      const auto of = [&](int curve) { return weight * static_cast<double>(curves[curve * n + i]); };
      const auto to = [&](int curve) -> double& { return curves_.coefs()[curve * n + i]; };
      const auto vector = [&](int x, int y, double from_x, double from_y) {
        to(x) += c * from_x - s * from_y;
        to(y) += s * from_x + c * from_y;
      };
      vector(0, 1, of(0), of(1));
      to(2) += of(2);
      // A tensor across the normal: its rows are turned as vectors, then its columns.
      const auto rows = [&](double xx, double xy, double yx, double yy) {
        const double first[2] = {c * xx - s * yx, c * xy - s * yy}, second[2] = {s * xx + c * yx, s * xy + c * yy};
        return Tensor{c * first[0] - s * first[1], s * first[0] + c * first[1], c * second[0] - s * second[1],
                      s * second[0] + c * second[1]};
      };
      const Tensor k = rows(of(3), of(4), of(4), of(5)), across = rows(of(9), of(10), of(12), of(13));
      to(3) += k.xx;
      to(4) += k.xy;
      to(5) += k.yy;
      vector(6, 7, of(6), of(7));
      to(8) += of(8);
      to(9) += across.xx;
      to(10) += across.xy;
      to(12) += across.yx;
      to(13) += across.yy;
      vector(11, 14, of(11), of(14));
    }
  }

  /// layout::kTorqueCurves curves of `count` coefficients each.
  [[nodiscard]] const double* coefs() const { return curves_.coefs(); }

  /// At a deflection (m) and a rotation vector (rad, of length at most pi), with `law` of the same responses.
  [[nodiscard]] Wrench answer(const Law& law, const Triple& d, const Triple& theta) const {
    const Law::AtDepth moved = law.at(d.n);
    const auto turned = curves_.at(d.n);
    const Stretch stretch(std::sqrt(dot(theta, theta)));
    const Triple u = stretch.odd.of(theta), v = stretch.even.of(theta);
    Wrench w;
    w.force = Law::force(moved, d.x, d.y);
    const Triple push = pushed(turned.value, u), held = odd(turned.value, d.x, d.y), bent = even(turned.value, v);
    w.force.x -= push.x;
    w.force.y -= push.y;
    w.force.n += dot(odd(turned.slope, d.x, d.y), u) + 0.5 * dot(even(turned.slope, v), v);
    const Triple a = stretch.odd.pull(theta, held), b = stretch.even.pull(theta, bent);
    const Triple t = per_angular_velocity(theta, {a.x + b.x, a.y + b.y, a.n + b.n});
    w.torque = {-t.x, -t.y, -t.n};
    return w;
  }

  /// Finds a deflection and a rotation with this force (N) and without torque. As Law::find; false, too,
  /// where the rotation is more than layout::kMaxRotation.
  [[nodiscard]] bool find(const Law& law, const Triple& force, Triple& d, Triple& theta) const {
    const bool found = Law::find_depth(law.range(), [&](double z) {
      const Law::AtDepth moved = law.at(z);
      const auto turned = curves_.at(z);
      double m[5][6];
      stiffness(moved.value + 3, turned.value + 3, m);
      const double load[5] = {moved.value[0] - force.x, moved.value[1] - force.y, turned.value[0], turned.value[1],
                              turned.value[2]};
      for (int i = 0; i < 5; ++i) m[i][5] = load[i];
      if (!solve_positive(m)) return std::nan("");
      d = {m[0][5], m[1][5], z};
      theta = {m[2][5], m[3][5], m[4][5]};
      return Law::force(moved, d.x, d.y).n + dot(odd(turned.slope, d.x, d.y), theta) +
             0.5 * dot(even(turned.slope, theta), theta) - force.n;
    });
    return found && dot(theta, theta) <= layout::kMaxRotation * layout::kMaxRotation;
  }

private:
  struct Tensor {
    double xx, xy, yx, yy;
  };
  /// C u.
  [[nodiscard]] static Triple pushed(const double* t, const Triple& u) {
    return {t[9] * u.x + t[10] * u.y + t[11] * u.n, t[12] * u.x + t[13] * u.y + t[14] * u.n, 0};
  }
  /// -T + C^T e: what W has beside u.
  [[nodiscard]] static Triple odd(const double* t, double x, double y) {
    return {t[9] * x + t[12] * y - t[0], t[10] * x + t[13] * y - t[1], t[11] * x + t[14] * y - t[2]};
  }
  /// K v.
  [[nodiscard]] static Triple even(const double* t, const Triple& v) {
    return {t[3] * v.x + t[4] * v.y + t[6] * v.n, t[4] * v.x + t[5] * v.y + t[7] * v.n,
            t[6] * v.x + t[7] * v.y + t[8] * v.n};
  }

  Curves<static_cast<int>(layout::kTorqueCurves)> curves_;
};

}  // namespace palpate::bonded
