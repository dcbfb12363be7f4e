// SPDX-License-Identifier: MIT
#include "device/glove/hand_model.hpp"

#include "device/device.hpp"

#include <cmath>

namespace palpate::device {
namespace {

constexpr double kDegree = kPi / 180;

/// About the hand's z axis, to the thumb's side, then about the finger's own axis.
Pose turned(double splay, double roll) {
  const Pose first = Pose::from_quaternion(std::cos(splay / 2), 0, 0, std::sin(splay / 2), {});
  const Pose second = Pose::from_quaternion(std::cos(roll / 2), 0, std::sin(roll / 2), 0, {});
  return first * second;
}

}  // namespace

const char* finger_name(std::size_t finger) {
  constexpr const char* kNames[] = {"thumb", "index", "middle finger", "ring finger", "little finger"};
  return finger < kFingers ? kNames[finger] : "?";
}

const char* joint_name(std::size_t joint) {
  constexpr const char* kNames[] = {"spread", "root", "middle joint"};
  return joint < kJoints ? kNames[joint] : "?";
}

Pose FingerModel::tip(const std::array<double, kJoints>& angles) const {
  const double turn = side * angles[Joint::spread], c = std::cos(turn), s = std::sin(turn);
  const double flexion[] = {angles[Joint::root], angles[Joint::root] + angles[Joint::middle],
                            angles[Joint::root] + (1 + coupling) * angles[Joint::middle]};
  Vec3 end;
  for (std::size_t k = 0; k < 3; ++k) {
    const double ahead = bones[k] * std::cos(flexion[k]);
    end = end + Vec3{-s * ahead, c * ahead, -bones[k] * std::sin(flexion[k])};
  }
  const double cf = std::cos(flexion[2]), sf = std::sin(flexion[2]);
  return base * Pose{{c, -s * cf, -s * sf, s, c * cf, c * sf, 0, -sf, cf}, end};
}

HandModel typical_hand() {
  HandModel hand;
  hand[0] = {turned(45 * kDegree, -60 * kDegree), {0.0462, 0.0316, 0.0217}};
  hand[0].base.translation = {-0.020, 0.020, -0.010};
  constexpr struct {
    double palm, bones[3], splay, side;
  } kLong[] = {{0.0681, {0.0398, 0.0224, 0.0158}, 10, 1},
               {0.0646, {0.0446, 0.0263, 0.0174}, 0, 0},
               {0.0580, {0.0414, 0.0257, 0.0173}, -10, -1},
               {0.0537, {0.0327, 0.0181, 0.0160}, -20, -1}};
  constexpr Vec3 kCarpus{0, 0.025, 0};  // m, to where the bones of the palm begin
  for (std::size_t k = 1; k < kFingers; ++k) {
    const auto& its = kLong[k - 1];
    FingerModel& finger = hand[k];
    finger.base = turned(its.splay * kDegree, 0);
    finger.base.translation = kCarpus + finger.base.rotate({0, its.palm, 0});
    finger.bones = {its.bones[0], its.bones[1], its.bones[2]};
    finger.side = its.side;
  }
  return hand;
}

}  // namespace palpate::device
