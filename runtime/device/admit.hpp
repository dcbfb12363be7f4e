// SPDX-License-Identifier: MIT
// What of a command a device is given: the rules that Device::write() promises, in one place for every device.
#pragma once

#include "device/device.hpp"
#include "palpate/output/output_chain.hpp"

#include <cmath>

namespace palpate::device {

/// Whether a command is still believed at `time` (s): it is no older than kStale, and not of a later time by more.
inline bool fresh(const Command& command, double time) {
  // Written so that a NaN fails the comparison.
  return std::fabs(time - command.time) <= kStale;
}

/// What to send at `time` (s): zero where the command is not fresh or not finite; a force beyond kind.peak_force
/// shortened along its line, a pull to it, or to 0 where it pushes.
inline Command admitted(const Command& command, const DeviceKind& kind, double time) {
  if (!fresh(command, time) || !finite(command.force) || !finite(command.torque) || !finite(command.pull)) {
    return {time, {}, {}};
  }
  return {command.time, runtime::output::Limit{kind.peak_force}(command.force, 0), command.torque,
          limited(command.pull, kind.peak_force)};
}

}  // namespace palpate::device
