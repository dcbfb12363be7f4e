// SPDX-License-Identifier: MIT
// The size of a hand and what its glove's sensors mean, from recorded extreme poses.
#pragma once

#include "device/glove/hand_model.hpp"

#include <optional>
#include <string>
#include <vector>

namespace palpate::device {

/// A pose that was held while the glove was read.
struct KeyPose {
  std::string name;
  HandJoints angles{};             ///< rad, the prescribed pose
  std::vector<HandJoints> frames;  ///< readings of the sensors
  /// m, hand's frame: where the fingertips were (a ruler, a tracker, a jig). In two poses or more.
  std::optional<std::array<Vec3, kFingers>> tips;
};

/// Flat (all straight), spread, and fist: the usual ends of the joints' range, without frames and tips.
std::vector<KeyPose> extreme_poses();

struct CalibrationOptions {
  double sensor_low = 0, sensor_high = 255;  ///< ends of the sensors' range, low below high: there they are saturated
  std::size_t least_frames = 20;             ///< of each pose, at least 1
  double least_share = 0.04;           ///< (0, 1) of the sensors' range that each must move through between the poses
  double most_unrest = 0.05;           ///< (0, 1): standard deviation in a held pose, of the way between the poses
  double most_angle_error = 0.1;       ///< rad, above 0: by which the poses may contradict one another
  double most_tip_error = 0.015;       ///< m, above 0: by which the hand with its found size may miss the measured tips
  double smallest = 0.5, largest = 2;  ///< range of accepted finger sizes, 1 being the typical hand's

  /// The first invalid value, with its range; empty when all are valid.
  [[nodiscard]] std::optional<std::string> validate() const;
};

/// The line of a sensor: its reading is at_zero + per_radian times the angle.
struct SensorLine {
  double at_zero = 0, per_radian = 0;
};

struct HandCalibration {
  std::string problem = "the hand was not calibrated";  ///< empty: usable; else why not, by pose, finger and joint
  HandModel hand;
  std::array<std::array<SensorLine, kJoints>, kFingers> sensors;
  std::array<double, kFingers> size{};  ///< of each finger, 1 being the typical hand's
  double angle_error = 0;               ///< rad, largest by which a pose misses the sensors' lines
  double tip_error = 0;                 ///< m, largest by which the hand misses a measured tip

  [[nodiscard]] bool usable() const { return problem.empty(); }

  /// rad, of what the sensors read; also beyond the recorded ends. Only where usable().
  [[nodiscard]] HandJoints angles(const HandJoints& raw) const;
};

/// Maciel et al. 2004 (section 4.2, eq. 14) take two references a sensor, from key poses, and give the angle between
/// them in proportion; how the lengths of their hand follow they do not say. Here a sensor's line is fitted to all
/// poses by least squares (with two poses it is theirs; their exponent against a sensor that is not straight is left
/// out). Each finger's size and its root are those with which the typical hand's chain, at the poses' angles, comes
/// nearest to the measured tips, also by least squares; proportions within a finger and its base's direction stay
/// typical. The middle finger's spread is no sensor: the others spread away from it.
HandCalibration calibrate_hand(const std::vector<KeyPose>& poses, const CalibrationOptions& options = {});

}  // namespace palpate::device
