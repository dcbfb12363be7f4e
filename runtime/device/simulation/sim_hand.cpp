// SPDX-License-Identifier: MIT
#include "device/simulation/sim_hand.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::device {

SimHand::SimHand(const SimHandOptions& options) : options_(options), random_(options.seed), hand_(typical_hand()) {
  for (FingerModel& finger : hand_) {
    const auto own = [&] { return options.size * (1 + between(-options.shape, options.shape)); };
    finger.base.translation = own() * finger.base.translation;
    for (double& bone : finger.bones) bone *= own();
  }
  for (auto& finger : sensors_) {
    for (SensorLine& line : finger) {
      const bool falls = random_() % 2 == 1;
      line.per_radian = (falls ? -1 : 1) * between(75, 95);
      line.at_zero = falls ? between(200, 220) : between(35, 55);
    }
  }
}

/// In [low, high).
double SimHand::between(double low, double high) {
  return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1p-53);
}

HandJoints SimHand::read(const HandJoints& angles) {
  HandJoints raw{};
  for (std::size_t f = 0; f < kFingers; ++f) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double reading = sensors_[f][j].at_zero + sensors_[f][j].per_radian * angles[f][j];
      const double steps = (reading + between(-options_.noise, options_.noise)) / options_.step;
      raw[f][j] = std::clamp(options_.step * std::round(steps), 0.0, 255.0);
    }
  }
  return raw;
}

std::vector<KeyPose> SimHand::record() {
  std::vector<KeyPose> poses = extreme_poses();
  for (KeyPose& pose : poses) {
    HandJoints held = pose.angles;
    for (auto& finger : held) {
      for (double& angle : finger) angle += between(-options_.astray, options_.astray);
    }
    for (int k = 0; k < 50; ++k) pose.frames.push_back(read(held));
    pose.tips.emplace();
    for (std::size_t f = 0; f < kFingers; ++f) {
      const auto off = [&] { return between(-options_.measured, options_.measured); };
      (*pose.tips)[f] = tip(f, held).translation + Vec3{off(), off(), off()};
    }
  }
  return poses;
}

}  // namespace palpate::device
