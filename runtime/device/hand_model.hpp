// SPDX-License-Identifier: MIT
// A hand as five chains of bones: from the angles of its joints to where its fingertips are.
#pragma once

#include "palpate/math/pose.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::device {

using runtime::Pose;
using runtime::Vec3;

inline constexpr std::size_t kFingers = 5;  ///< thumb, index, middle, ring, little
inline constexpr std::size_t kJoints = 3;   ///< of a finger, that a glove measures

/// Joints of a finger that a glove measures. The last one of each finger follows the middle one
/// (FingerModel::coupling).
struct Joint {
  enum : std::size_t {
    spread,  ///< abduction, positive away from the middle finger
    root,    ///< flexion where the finger leaves the palm (of the thumb: the wrist)
    middle   ///< flexion of the next joint
  };
};

/// A number for every joint of a hand: an angle (rad), or what its sensor reads.
using HandJoints = std::array<std::array<double, kJoints>, kFingers>;

/// N, at least 0: how strongly the cable of each finger pulls.
using Pulls = std::array<double, kFingers>;

inline bool finite(const Pulls& pull) {
  return std::all_of(pull.begin(), pull.end(), [](double each) { return std::isfinite(each); });
}

/// Each from 0 to `most` (N); finite pulls.
inline Pulls limited(Pulls pull, double most) {
  for (double& each : pull) each = std::clamp(each, 0.0, most);
  return pull;
}

const char* finger_name(std::size_t finger);
const char* joint_name(std::size_t joint);

/// One chain. Its base frame is at the root joint: y along the straight finger, z to the back of the hand.
struct FingerModel {
  Pose base;                      ///< in the hand's frame
  std::array<double, 3> bones{};  ///< m, from the root outwards
  double coupling = 2.0 / 3;      ///< flexion of the last joint by that of the middle one (Rijpkema and Girard 1991)
  double side = 1;                ///< 1: spreads towards the thumb; -1: away from it; 0: others spread away from it

  /// The end of the last bone, which is where a fingertip's sphere has its centre. y along that bone, z to the nail:
  /// the way in which a cable that opens the hand pulls.
  [[nodiscard]] Pose tip(const std::array<double, kJoints>& angles) const;
};

/// A right hand: origin at the wrist, y to the knuckle of the middle finger, z to the back of the hand, x to the little
/// finger.
using HandModel = std::array<FingerModel, kFingers>;

/// Mean lengths of bones (Buryanov and Kotiuk 2010, Int. J. Morphol. 28(3), 755: x-rays of 66 adults). How the bones of
/// the palm lie, and that the thumb's last joint is coupled as the fingers' are, is assumed.
HandModel typical_hand();

}  // namespace palpate::device
