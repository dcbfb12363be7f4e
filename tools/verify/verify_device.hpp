// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify FILE.palp --device NAME`: whether a scene is safe to touch with a device, before touching it.
#pragma once

#include "tools/cli/commands.hpp"

#include <string>

namespace palpate::cli {

struct DeviceCommand {
  std::string response;  ///< file
  std::string device;    ///< a simulated kind, its "sim-" may be left out
  std::string report;    ///< also write the JSON there; empty: no
  double rate = 1000;    ///< Hz of the force loop
  double scale = 1;      ///< N/m in the hand per N/m of the scene
};

/// Prints the figures and what makes the file safe. Throws Error(tolerance) where it oscillates in a usual grip.
void run_device_command(const DeviceCommand& command, const Globals& globals);

}  // namespace palpate::cli
