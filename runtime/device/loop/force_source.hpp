// SPDX-License-Identifier: MIT
// The source of a force loop's forces: a sample of the device in, a force on the hand out.
#pragma once

#include "device/device.hpp"

namespace palpate::device {

/// A source's answer to a sample; vectors in the device's frame.
struct Answer {
  Vec3 force;           ///< N
  Vec3 torque;          ///< N m
  double depth = 0;     ///< m in the scene; for displays and recordings
  Pulls pull{};         ///< N, of a glove's cables
  bool usable = false;  ///< false: no force is to be made of this (no pose, a tracker that is late or dead)
};

/// Computes forces from samples. The loop calls it from its own thread: it does not wait, lock, allocate or throw.
/// The same calls after the same reset() give the same bits, so that a recording can be replayed.
class ForceSource {
public:
  virtual ~ForceSource() = default;

  /// `seconds` since the last call, above 0. Only the measured parts of the sample are used: pose and joints.
  virtual Answer answer(const Sample& sample, double seconds) noexcept = 0;

  /// As if nothing had been touched: what overlaps then must start without force.
  virtual void reset() noexcept = 0;
};

}  // namespace palpate::device
