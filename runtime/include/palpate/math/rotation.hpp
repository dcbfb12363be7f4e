// SPDX-License-Identifier: MIT
// Rotation vectors: axis times angle (rad).
#pragma once

#include "palpate/math/pose.hpp"

#include <cmath>

namespace palpate::runtime {

/// Returns the rotation vector of a small rotation, to first order: axis times sine of the angle.
inline Vec3 small_rotation(const Pose& pose) {
  const double* m = pose.rotation;
  return 0.5 * Vec3{m[7] - m[5], m[2] - m[6], m[3] - m[1]};
}

/// Returns the rotation vector (length at most pi) of a row-major rotation matrix. The method takes the largest
/// component of the quaternion (Shepperd 1978). Two vectors describe a rotation by pi; the function returns one of
/// them.
inline Vec3 rotation_vector(const double (&r)[9]) {
  const double squares[4] = {1 + r[0] + r[4] + r[8], 1 + r[0] - r[4] - r[8], 1 - r[0] + r[4] - r[8],
                             1 - r[0] - r[4] + r[8]};
  int most = 0;
  for (int k = 1; k < 4; ++k) most = squares[k] > squares[most] ? k : most;
  const double differences[3] = {r[7] - r[5], r[2] - r[6], r[3] - r[1]};
  const double sums[3] = {r[5] + r[7], r[2] + r[6], r[1] + r[3]};  // yz, xz, xy
  double w = squares[0];
  Vec3 v{differences[0], differences[1], differences[2]};
  if (most > 0) w = differences[most - 1];
  if (most == 1) v = {squares[1], sums[2], sums[1]};
  if (most == 2) v = {sums[2], squares[2], sums[0]};
  if (most == 3) v = {sums[1], sums[0], squares[3]};
  const double sine = length(v);
  if (!(sine > 0)) return {};
  const double angle = 2 * std::atan2(sine, std::fabs(w));
  return (std::copysign(angle, w) / sine) * v;
}

/// Returns the pose without translation that rotates by a rotation vector.
inline Pose rotation_pose(const Vec3& rotation) {
  const double angle = length(rotation);
  const Vec3 axis = angle > 0 ? (std::sin(angle / 2) / angle) * rotation : Vec3{};
  return Pose::from_quaternion(std::cos(angle / 2), axis.x, axis.y, axis.z, {});
}

}  // namespace palpate::runtime
