// SPDX-License-Identifier: MIT
// Rigid poses, and the motion from one to another.
#pragma once

#include "palpate/format/full_turn.hpp"
#include "palpate/math/vec3.hpp"

namespace palpate::runtime {

using palpate::kFullTurn;

/// The tool's frame in the body's: a tool point a lies at rotation * a + translation (m).
struct Pose {
  double rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row-major, orthonormal
  Vec3 translation;

  /// Pose of a quaternion of any length but zero.
  static Pose from_quaternion(double w, double x, double y, double z, const Vec3& translation) {
    const double s = 2.0 / (w * w + x * x + y * y + z * z);
    return {{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w),  //
             s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w),  //
             s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)},
            translation};
  }

  /// Pose of a tool whose origin lies at `point` (m) and whose z axis (tip to handle) points along the unit vector
  /// `axis`. The turn about that axis is any.
  static Pose from_axis(const Vec3& point, const Vec3& axis) {
    const Vec3 x = any_orthogonal(axis), y = cross(axis, x);
    return {{x.x, y.x, axis.x, x.y, y.y, axis.y, x.z, y.z, axis.z}, point};
  }

  [[nodiscard]] Vec3 rotate(const Vec3& a) const {
    const double* r = rotation;
    return {r[0] * a.x + r[1] * a.y + r[2] * a.z, r[3] * a.x + r[4] * a.y + r[5] * a.z,
            r[6] * a.x + r[7] * a.y + r[8] * a.z};
  }
  [[nodiscard]] Vec3 apply(const Vec3& a) const { return rotate(a) + translation; }
  /// A direction of the body's frame in the tool's.
  [[nodiscard]] Vec3 unrotate(const Vec3& a) const {
    const double* r = rotation;
    return {r[0] * a.x + r[3] * a.y + r[6] * a.z, r[1] * a.x + r[4] * a.y + r[7] * a.z,
            r[2] * a.x + r[5] * a.y + r[8] * a.z};
  }
  /// A point of the body's frame in the tool's.
  [[nodiscard]] Vec3 unapply(const Vec3& a) const { return unrotate(a - translation); }

  /// The tool's z axis.
  [[nodiscard]] Vec3 axis() const { return {rotation[2], rotation[5], rotation[8]}; }

  /// Finite, within 1e6 m, and orthonormal to 1e-3.
  [[nodiscard]] bool valid() const {
    const double* r = rotation;
    const Vec3 a{r[0], r[1], r[2]}, b{r[3], r[4], r[5]}, third = cross(a, b) - Vec3{r[6], r[7], r[8]};
    constexpr double kFar = 1e6, kLoose = 1e-3;
    // Each comparison is false for a NaN.
    return std::fabs(translation.x) < kFar && std::fabs(translation.y) < kFar && std::fabs(translation.z) < kFar &&
           std::fabs(dot(a, a) - 1) < kLoose && std::fabs(dot(b, b) - 1) < kLoose && std::fabs(dot(a, b)) < kLoose &&
           dot(third, third) < kLoose * kLoose;
  }
};

inline bool operator==(const Pose& a, const Pose& b) {
  bool same = a.translation.x == b.translation.x && a.translation.y == b.translation.y &&
              a.translation.z == b.translation.z;
  for (int k = 0; k < 9; ++k) same = same && a.rotation[k] == b.rotation[k];
  return same;
}

/// First b, then a: a point goes to a.apply(b.apply(point)).
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

/// Inverse of an orthonormal pose.
inline Pose inverse(const Pose& pose) {
  const double* r = pose.rotation;
  Pose back{{r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]}, {}};
  back.translation = -back.rotate(pose.translation);
  return back;
}

/// A valid pose with its rotation made orthonormal to rounding.
inline Pose orthonormal(const Pose& pose) {
  const double* r = pose.rotation;
  const Vec3 a = unit({r[0], r[1], r[2]}, {}), b = unit(tangential({r[3], r[4], r[5]}, a), {}), c = cross(a, b);
  return {{a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z}, pose.translation};
}

/// Motion from one pose to another: by how much each point of a tool goes.
struct Motion {
  double rotation[9];  ///< change of the rotation, row-major
  Vec3 translation;    ///< m

  Motion(const Pose& from, const Pose& to) : translation(to.translation - from.translation) {
    for (int k = 0; k < 9; ++k) rotation[k] = to.rotation[k] - from.rotation[k];
  }
  /// m, way of a point of the tool's frame; exactly 0 at rest.
  [[nodiscard]] Vec3 of(const Vec3& a) const {
    const double* r = rotation;
    return {r[0] * a.x + r[1] * a.y + r[2] * a.z + translation.x, r[3] * a.x + r[4] * a.y + r[5] * a.z + translation.y,
            r[6] * a.x + r[7] * a.y + r[8] * a.z + translation.z};
  }
  /// m, bound on the way of every point within `radius` (m) of the tool's origin.
  [[nodiscard]] double travel(double radius) const {
    double squared = 0;
    for (int k = 0; radius > 0 && k < 9; ++k) squared += rotation[k] * rotation[k];
    return length(translation) + std::sqrt(squared) * radius;
  }
};

/// Largest distance (m) that a point within `radius` (m) of the tool's origin travels from one pose to another.
inline double travel(const Pose& from, const Pose& to, double radius) { return Motion(from, to).travel(radius); }

/// A pose on the way from one to another, at a share [0, 1] of it: positions linearly, rotations made orthonormal after
/// a linear blend.
inline Pose between(const Pose& from, const Pose& to, double share) {
  Pose result;
  for (int k = 0; k < 9; ++k) result.rotation[k] = from.rotation[k] + share * (to.rotation[k] - from.rotation[k]);
  result.translation = from.translation + share * (to.translation - from.translation);
  return orthonormal(result);
}

}  // namespace palpate::runtime
