// SPDX-License-Identifier: MIT
#include "device/recording/run_hand.hpp"

#include <cmath>
#include <cstring>

namespace palpate::device {

RunHand to_run_hand(const HandCalibration& calibration, const GloveOptions& options) {
  RunHand r;
  for (std::size_t f = 0; f < kFingers; ++f) {
    const FingerModel& finger = calibration.hand[f];
    for (std::size_t j = 0; j < kJoints; ++j) {
      r.at_zero[f][j] = calibration.sensors[f][j].at_zero;
      r.per_radian[f][j] = calibration.sensors[f][j].per_radian;
    }
    const Vec3& at = finger.base.translation;
    std::memcpy(r.rotation[f], finger.base.rotation, sizeof r.rotation[f]);
    r.origin[f][0] = at.x, r.origin[f][1] = at.y, r.origin[f][2] = at.z;
    std::memcpy(r.bones[f], finger.bones.data(), sizeof r.bones[f]);
    r.coupling[f] = finger.coupling;
    r.side[f] = finger.side;
  }
  r.limit = options.limit;
  r.rate = options.rate;
  r.frequency = options.frequency;
  return r;
}

HandCalibration calibration_of(const RunHand& r) {
  HandCalibration calibration;
  calibration.problem.clear();
  for (std::size_t f = 0; f < kFingers; ++f) {
    FingerModel& finger = calibration.hand[f];
    for (std::size_t j = 0; j < kJoints; ++j) calibration.sensors[f][j] = {r.at_zero[f][j], r.per_radian[f][j]};
    std::memcpy(finger.base.rotation, r.rotation[f], sizeof r.rotation[f]);
    finger.base.translation = {r.origin[f][0], r.origin[f][1], r.origin[f][2]};
    std::memcpy(finger.bones.data(), r.bones[f], sizeof r.bones[f]);
    finger.coupling = r.coupling[f];
    finger.side = r.side[f];
  }
  return calibration;
}

GloveOptions glove_options(const RunHand& r) { return {r.limit, r.rate, r.frequency}; }

const char* wrong_in(const RunHand& r) {
  if (!glove_options(r).valid()) return "the limit, rate or frequency of the pulls is out of range";
  const HandCalibration calibration = calibration_of(r);
  double sum = 0;  // finite where all are
  for (std::size_t f = 0; f < kFingers; ++f) {
    const FingerModel& finger = calibration.hand[f];
    if (!finger.base.valid()) return "the root of a finger is no pose";
    for (const SensorLine& line : calibration.sensors[f]) sum += std::fabs(line.at_zero) + std::fabs(line.per_radian);
    for (const double bone : finger.bones) sum += std::fabs(bone);
    sum += std::fabs(finger.coupling) + std::fabs(finger.side);
  }
  return std::isfinite(sum) ? nullptr : "a number of the hand is not finite";
}

}  // namespace palpate::device
