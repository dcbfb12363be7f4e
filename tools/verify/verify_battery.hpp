// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify --battery stiff`: the stability table.
#pragma once

#include "tools/cli/commands.hpp"

#include <cstdint>
#include <string>

namespace palpate::cli {

struct BatteryCommand {
  std::string report;  ///< JSON file; empty: none
  std::string family;  ///< only this one; empty: all
  std::string cells;   ///< only those with this in their name; empty: all
  std::uint64_t seed = 1;
};

/// Prints a table in Markdown (--json: JSON). Throws Error(tolerance) where a cell is wrong, or too few converge: 90 %
/// of the core range and 70 % of all are wanted.
void run_battery_command(const BatteryCommand& command, const Globals& globals);

}  // namespace palpate::cli
