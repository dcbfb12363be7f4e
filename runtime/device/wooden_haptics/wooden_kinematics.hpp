// SPDX-License-Identifier: MIT
// The arm of the WoodenHaptics: a column that turns (A), an upper body (B) and a lower body (C), each driven by a
// capstan.
#pragma once

#include "palpate/math/pose.hpp"

#include <array>

namespace palpate::device {

/// One number for each of the joints A, B, C.
using Joints = std::array<double, 3>;

/// Lengths and motors of an arm. The defaults are those of the published design.
struct WoodenGeometry {
  double column = 0.08;                 ///< m, height of the joints B and C
  double upper = 0.205, lower = 0.245;  ///< m
  Joints capstan{0.010, 0.010, 0.010};  ///< m, diameters
  Joints body{0.16, 0.12, 0.12};        ///< m, diameters that the cables lie on
  Joints sign{1, 1, 1};                 ///< -1 where motor and body turn opposite ways
  double counts = 2000;                 ///< of an encoder in one turn of its motor
  double torque_constant = 0.0259;      ///< N m/A
  runtime::Vec3 origin{0.22, 0, 0.08};  ///< m, the workspace's origin from the foot of the column

  /// The first invalid value, with its range, or null.
  [[nodiscard]] const char* validate() const;
};

/// rad from encoder counts since the pose of all zero angles: column facing along x, upper body up, lower body down.
Joints angles(const WoodenGeometry& geometry, const Joints& counts);

/// The counts (not rounded) at which angles() gives these.
Joints counts(const WoodenGeometry& geometry, const Joints& angles);

/// m from the workspace's origin.
runtime::Vec3 position(const WoodenGeometry& geometry, const Joints& angles);

/// d position / d angle (m/rad), one vector a joint.
std::array<runtime::Vec3, 3> jacobian(const WoodenGeometry& geometry, const Joints& angles);

/// The angles that bring the tip to `position`, with the tip in front of the column and B + C from 0 to pi; false, and
/// nothing changed, beyond the arm's reach. At the column's axis A is 0.
bool reach(const WoodenGeometry& geometry, const runtime::Vec3& position, Joints& angles);

/// A in each motor, for a force (N) at the tip.
Joints currents(const WoodenGeometry& geometry, const Joints& angles, const runtime::Vec3& force);

}  // namespace palpate::device
