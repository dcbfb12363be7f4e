// SPDX-License-Identifier: MIT
// A hand that nobody knows, in a glove: what its sensors read, and where its fingertips truly are.
#pragma once

#include "device/glove/hand_calibration.hpp"

#include <cstdint>
#include <random>

namespace palpate::device {

struct SimHandOptions {
  std::uint64_t seed = 1;
  double size = 1;      ///< of the hand, 1 being the typical one's
  double shape = 0;     ///< each bone and root apart from the typical hand's by up to this share
  double step = 1;      ///< counts, to which a sensor rounds
  double noise = 0.5;   ///< counts, either way, before it does
  double astray = 0;    ///< rad, by which a hand misses the angle that a pose prescribes
  double measured = 0;  ///< m, by which a measured tip is off, per axis
};

/// Sensors from 0 to 255, each with a gain of its own (of either sign) and an offset. The same seed gives the same
/// hand, and the same calls the same readings.
class SimHand {
public:
  explicit SimHand(const SimHandOptions& options = {});

  /// Readings of the sensors at these angles (rad). Allocates nothing.
  HandJoints read(const HandJoints& angles);

  /// In the hand's frame.
  [[nodiscard]] Pose tip(std::size_t finger, const HandJoints& angles) const {
    return hand_[finger].tip(angles[finger]);
  }

  /// The recording of extreme_poses() by a simulated wearer.
  std::vector<KeyPose> record();

private:
  double between(double low, double high);

  SimHandOptions options_;
  std::mt19937_64 random_;  // by its bits alone: distributions differ from library to library
  HandModel hand_;
  std::array<std::array<SensorLine, kJoints>, kFingers> sensors_;
};

}  // namespace palpate::device
