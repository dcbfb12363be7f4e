// SPDX-License-Identifier: MIT
// A hand as five chains of bones: from the angles of its joints to where its fingertips are.
#pragma once

#include "device/hand_types.hpp"
#include "palpate/math/pose.hpp"

#include <array>

namespace palpate::device {

using runtime::Pose;
using runtime::Vec3;

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
