// SPDX-License-Identifier: MIT
// Three-vectors and rigid poses of the runtime.
#pragma once

#include <cmath>

// What is no pose, no force or no record of a file is found by comparing with NaN and infinity, and a sum is taken in
// the order in which it stands. Clang has no macro for a change of that order alone.
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(__ASSOCIATIVE_MATH__)
#error "Palpate needs IEEE arithmetic: no -ffast-math, -Ofast, -ffinite-math-only or -funsafe-math-optimizations"
#endif

/// Of small functions that every tick calls often: the more else a program holds, the fewer of them compilers would
/// inline, some 4 % of a tick. Where size is asked for it is left to them.
#ifdef __OPTIMIZE_SIZE__
#define PALPATE_TICK_INLINE inline
#define PALPATE_INLINE_LAMBDA
#else
#define PALPATE_TICK_INLINE [[gnu::always_inline]] inline
#define PALPATE_INLINE_LAMBDA __attribute__((always_inline))
#endif

namespace palpate::runtime {

inline constexpr double kFullTurn = 6.283185307179586;  ///< rad

struct Vec3 {
  double x = 0, y = 0, z = 0;
};

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
PALPATE_TICK_INLINE double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
/// Finite, and short enough for its square to be.
inline bool finite(const Vec3& a) { return std::isfinite(dot(a, a)); }
inline Vec3 to_vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

/// `v` without its part along the unit vector n.
PALPATE_TICK_INLINE Vec3 tangential(const Vec3& v, const Vec3& n) { return v - dot(v, n) * n; }

/// Unit vector along v; `otherwise` where v is too short to have a direction.
PALPATE_TICK_INLINE Vec3 unit(const Vec3& v, const Vec3& otherwise) {
  const double size = length(v);
  return size > 1e-12 ? (1.0 / size) * v : otherwise;
}

/// Some unit vector orthogonal to the unit vector n, without a root (Duff and others, JCGT 6(1), 2017).
inline Vec3 any_orthogonal(const Vec3& n) {
  const double sign = std::copysign(1.0, n.z), a = n.x / (sign + n.z);
  return {1 - sign * n.x * a, -sign * n.y * a, -sign * n.x};
}

/// The tool's frame in the body's: a tool point a lies at rotation * a + translation (m).
struct Pose {
  double rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row-major, orthonormal
  Vec3 translation;

  /// From a quaternion of any length but zero.
  static Pose from_quaternion(double w, double x, double y, double z, const Vec3& translation) {
    const double s = 2.0 / (w * w + x * x + y * y + z * z);
    return {{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w),  //
             s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w),  //
             s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)},
            translation};
  }

  [[nodiscard]] PALPATE_TICK_INLINE Vec3 rotate(const Vec3& a) const {
    const double* r = rotation;
    return {r[0] * a.x + r[1] * a.y + r[2] * a.z, r[3] * a.x + r[4] * a.y + r[5] * a.z,
            r[6] * a.x + r[7] * a.y + r[8] * a.z};
  }
  [[nodiscard]] PALPATE_TICK_INLINE Vec3 apply(const Vec3& a) const { return rotate(a) + translation; }

  /// Component along the tool's z axis of a direction given in the body's frame.
  [[nodiscard]] double along_axis(const Vec3& direction) const {
    return dot({rotation[2], rotation[5], rotation[8]}, direction);
  }

  /// Finite, within 1e6 m, and orthonormal to 1e-3.
  [[nodiscard]] bool valid() const {
    const double* r = rotation;
    const Vec3 a{r[0], r[1], r[2]}, b{r[3], r[4], r[5]}, c{r[6], r[7], r[8]};
    constexpr double kFar = 1e6, kLoose = 1e-3;
    // Written so that a NaN fails every comparison.
    return std::fabs(translation.x) < kFar && std::fabs(translation.y) < kFar && std::fabs(translation.z) < kFar &&
           std::fabs(dot(a, a) - 1) < kLoose && std::fabs(dot(b, b) - 1) < kLoose &&
           std::fabs(dot(c, c) - 1) < kLoose && std::fabs(dot(a, b)) < kLoose && std::fabs(dot(b, c)) < kLoose &&
           std::fabs(dot(cross(a, b), c) - 1) < 4 * kLoose;
  }
};

/// First b, then a: a point goes where a.apply(b.apply(point)) is.
inline Pose operator*(const Pose& a, const Pose& b) {
  Pose both;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      both.rotation[3 * i + j] = a.rotation[3 * i] * b.rotation[j] + a.rotation[3 * i + 1] * b.rotation[3 + j] +
                                 a.rotation[3 * i + 2] * b.rotation[6 + j];
    }
  }
  both.translation = a.apply(b.translation);
  return both;
}

/// Of an orthonormal pose: the way back.
inline Pose inverse(const Pose& pose) {
  const double* r = pose.rotation;
  Pose back{{r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]}, {}};
  back.translation = -back.rotate(pose.translation);
  return back;
}

/// A pose that is valid, orthonormal as far as numbers go: as smooth as it was.
inline Pose orthonormal(const Pose& pose) {
  const double* r = pose.rotation;
  const Vec3 a = unit({r[0], r[1], r[2]}, {}), b = unit(tangential({r[3], r[4], r[5]}, a), {}), c = cross(a, b);
  return {{a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z}, pose.translation};
}

/// Axis times the sine of the angle by which it turns: for small ones the rotation vector (rad).
inline Vec3 small_turn(const Pose& pose) {
  const double* m = pose.rotation;
  return 0.5 * Vec3{m[7] - m[5], m[2] - m[6], m[3] - m[1]};
}

}  // namespace palpate::runtime
