// SPDX-License-Identifier: MIT
// The command that is sent to a device: the rules of Device::write(), in one place for every device.
#pragma once

#include "device/device.hpp"
#include "palpate/output/output_chain.hpp"

#include <cmath>

namespace palpate::device {

/// Whether a command is valid at `time` (s): it differs from the command's own time by at most kStale.
inline bool fresh(const Command& command, double time) {
  // Written so that a NaN fails the comparison.
  return std::fabs(time - command.time) <= kStale;
}

/// The command to send at `time` (s): zero where it is not fresh or not finite; a force beyond kind.peak_force
/// shortened along its line, a pull to it, or to 0 where it pushes.
inline Command clamp_command(const Command& command, const DeviceKind& kind, double time) {
  if (!fresh(command, time) || !finite(command.force) || !finite(command.torque) || !finite(command.pull)) {
    return {time, {}, {}};
  }
  return {command.time, runtime::output::Limit{kind.peak_force}(command.force, 0), command.torque,
          limited(command.pull, kind.peak_force)};
}

}  // namespace palpate::device
