// SPDX-License-Identifier: MIT
// The hand in the recording of a glove's run: what its pulls were made with, as it lies on disk (run-record.md).
#pragma once

#include "device/glove/glove_options.hpp"
#include "device/glove/hand_calibration.hpp"

#include <cstdint>
#include <type_traits>

namespace palpate::device {

struct RunHand {
  double at_zero[kFingers][kJoints] = {}, per_radian[kFingers][kJoints] = {};  ///< SensorLine
  double rotation[kFingers][9] = {}, origin[kFingers][3] = {};                 ///< FingerModel::base
  double bones[kFingers][3] = {}, coupling[kFingers] = {}, side[kFingers] = {};
  double limit = 0, rate = 0, frequency = 0;  ///< GloveOptions
  std::uint64_t checksum = 0;                 ///< XXH64 of all before
};

static_assert(sizeof(RunHand) == 952 && std::is_trivially_copyable_v<RunHand>);

/// Converts a usable calibration, and back: the sensors' lines and the hand, from which angles and tips are computed.
RunHand to_run_hand(const HandCalibration& calibration, const GloveOptions& options);
HandCalibration calibration_of(const RunHand& hand);
GloveOptions glove_options(const RunHand& hand);

/// Null, or what no usable calibration has.
const char* wrong_in(const RunHand& hand);

}  // namespace palpate::device
