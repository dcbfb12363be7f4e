// SPDX-License-Identifier: GPL-3.0-or-later
// A glove on a hand that nobody knows: what its sensors read, and where its fingertips truly are.
#pragma once

#include "device/hand_calibration.hpp"
#include "tests/device/seeded.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::test {

struct SimulatedGloveOptions {
  double size = 1;      ///< of the hand, 1 being the typical one's
  double shape = 0;     ///< each bone and root apart from the typical hand's by up to this share
  double noise = 0.5;   ///< counts, either way, before the sensor rounds to whole ones
  double astray = 0;    ///< rad, by which a hand misses the angle that a pose asks for
  double measured = 0;  ///< m, by which a measured tip is off, per axis
};

/// Sensors of 8 bits, each with a gain of its own (of either sign) and an offset.
class SimulatedGlove {
public:
  SimulatedGlove(std::uint64_t seed, const SimulatedGloveOptions& options) : options_(options), random_(seed) {
    hand_ = device::typical_hand();
    for (device::FingerModel& finger : hand_) {
      const auto own = [&] { return options.size * (1 + random_.between(-options.shape, options.shape)); };
      finger.base.translation = own() * finger.base.translation;
      for (double& bone : finger.bones) bone *= own();
    }
    for (auto& finger : sensors_) {
      for (device::SensorLine& line : finger) {
        const bool falls = random_.below(2) == 1;
        line.per_radian = (falls ? -1 : 1) * random_.between(75, 95);
        line.at_zero = falls ? random_.between(200, 220) : random_.between(35, 55);
      }
    }
  }

  device::HandJoints read(const device::HandJoints& angles) {
    device::HandJoints raw{};
    for (std::size_t f = 0; f < device::kFingers; ++f) {
      for (std::size_t j = 0; j < device::kJoints; ++j) {
        const device::SensorLine& line = sensors_[f][j];
        const double reading = line.at_zero + line.per_radian * angles[f][j];
        raw[f][j] = std::clamp(std::round(reading + random_.between(-options_.noise, options_.noise)), 0.0, 255.0);
      }
    }
    return raw;
  }

  [[nodiscard]] runtime::Vec3 tip(std::size_t finger, const device::HandJoints& angles) const {
    return hand_[finger].tip(angles[finger]).translation;
  }

  /// What a person would record for device::extreme_poses().
  std::vector<device::KeyPose> record() {
    std::vector<device::KeyPose> poses = device::extreme_poses();
    for (device::KeyPose& pose : poses) {
      device::HandJoints held = pose.angles;
      for (auto& finger : held) {
        for (double& angle : finger) angle += random_.between(-options_.astray, options_.astray);
      }
      for (int k = 0; k < 50; ++k) pose.frames.push_back(read(held));
      pose.tips.emplace();
      for (std::size_t f = 0; f < device::kFingers; ++f) {
        const auto off = [&] { return random_.between(-options_.measured, options_.measured); };
        (*pose.tips)[f] = tip(f, held) + runtime::Vec3{off(), off(), off()};
      }
    }
    return poses;
  }

  /// Anything between the extreme poses.
  device::HandJoints any_pose() {
    const std::vector<device::KeyPose> ends = device::extreme_poses();
    device::HandJoints angles{};
    for (std::size_t f = 0; f < device::kFingers; ++f) {
      angles[f][device::Joint::spread] = random_.between(0, ends[1].angles[f][device::Joint::spread]);
      angles[f][device::Joint::root] = random_.between(0, ends[2].angles[f][device::Joint::root]);
      angles[f][device::Joint::middle] = random_.between(0, ends[2].angles[f][device::Joint::middle]);
    }
    angles[2][device::Joint::spread] = 0;
    return angles;
  }

private:
  SimulatedGloveOptions options_;
  Seeded random_;
  device::HandModel hand_;
  std::array<std::array<device::SensorLine, device::kJoints>, device::kFingers> sensors_;
};

}  // namespace palpate::test
