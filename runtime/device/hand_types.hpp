// SPDX-License-Identifier: MIT
// Samples and commands of a glove: a number for every joint of a hand, a pull for every finger.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace palpate::device {

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

}  // namespace palpate::device
