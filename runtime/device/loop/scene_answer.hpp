// SPDX-License-Identifier: MIT
// Maps a contact in the scene to the hand that holds the device.
#pragma once

#include "device/loop/force_source.hpp"
#include "palpate/contact/tick.hpp"
#include "palpate/output/device_frame.hpp"

namespace palpate::device {

/// A fault is not usable, and nothing.
inline Answer scene_answer(const runtime::DeviceFrame& frame, const runtime::Tick& tick) {
  Answer answer;
  if (tick.state == runtime::State::fault) return answer;
  answer.force = frame.to_device(tick.force);
  answer.torque = frame.torque_to_device(tick.torque);
  answer.depth = tick.depth;
  answer.usable = true;
  return answer;
}

}  // namespace palpate::device
