// SPDX-License-Identifier: MIT
// Kinematics and statics of the Novint Falcon: three arms that push one grip. Geometry and formulas: Stamper 1997 as in
// libnifalcon's documents; the gradient is our own, checked against finite differences (libnifalcon's code squares a
// sine too many).
#pragma once

#include "palpate/math/pose.hpp"

#include <array>
#include <cstdint>

namespace palpate::device::falcon {

using runtime::Vec3;

inline constexpr Vec3 kCentre{0, 0, 0.15};  ///< m: the middle of the workspace

/// Turns of the three arms' lower links (rad), or torques about their axes (N m).
using Triple = std::array<double, 3>;

/// One arm with the grip at some place. A turn dq of its lower link moves the grip so that pull . dx = lever dq.
struct Arm {
  double angle = 0;  ///< rad
  Vec3 pull;         ///< gradient of how far the forearm's ends are apart
  double lever = 0;  ///< m, not negative; 0 where lower link and forearm are in line
};

struct Arms {
  bool reached = false;  ///< false: some arm cannot get there, and nothing else holds
  std::array<Arm, 3> arm;

  [[nodiscard]] Triple angles() const { return {arm[0].angle, arm[1].angle, arm[2].angle}; }
};

/// The angles of the arms with the grip at `tip` (m), in closed form.
Arms inverse(const Vec3& tip);

/// d angle / d tip of an arm (rad/m). Grows without bound as the lever goes to 0.
inline Vec3 gradient(const Arm& arm) { return (1 / arm.lever) * arm.pull; }

struct Reached {
  bool ok = false;  ///< false: no place of the grip is near `start` and belongs to these angles
  Vec3 tip;         ///< m
  int steps = 0;    ///< that Newton took
};

/// The position of the grip for given angles: Newton on the lengths of the forearms, which stay smooth where the angles
/// are not (lever 0), from `start` (the last place) and, should that lead nowhere, from the middle of the workspace. A
/// step that would leave the domain is shortened. At most 80 evaluations, whatever comes in.
Reached forward(const Triple& angles, const Vec3& start);

/// Torques (N m) that press the grip with `force` (N) on the hand: (J^-1)^T F. Not finite where the arms cannot hold
/// that force.
Triple torques(const Arms& arms, const Vec3& force);

/// The angle (rad) of an arm's encoder.
double angle_of(std::int16_t encoder);

/// The encoder nearest to an angle (rad) within what its 16 bits hold.
std::int16_t encoder_of(double angle);

/// Motor counts of torques (N m): where one is beyond what a motor takes all are scaled, so that the force keeps its
/// direction; zero where a torque is not finite. Never wraps.
std::array<std::int16_t, 3> motors(const Triple& torques);

inline constexpr int kMostCounts = 4096;  ///< of a motor, either way

}  // namespace palpate::device::falcon
