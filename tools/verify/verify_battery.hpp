// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify --battery stiff` and `--battery random`: the stability table, and random scenes judged by finer
// meshes.
#pragma once

#include "tools/cli/commands.hpp"

#include <cstdint>
#include <string>

namespace palpate::cli {

struct BatteryCommand {
  std::string battery;       ///< stiff, random
  std::string report;        ///< stiff: JSON file; random: one JSON line a scene; empty: none
  std::string family;        ///< only this one; empty: all
  std::string cells;         ///< only those with this in their name; empty: all
  std::uint64_t seed = 1;    ///< stiff: of the checked share; random: of the scenes
  std::uint32_t first = 1;   ///< random: number of the first scene of the draw
  std::uint32_t count = 40;  ///< random: scenes
};

/// Prints a table in Markdown (--json: JSON). Throws Error(tolerance) where a stiff cell is wrong or too few converge
/// (90 % of the core range and 70 % of all are wanted), or where the random scenes break one of their bounds.
void run_battery_command(const BatteryCommand& command, const Globals& globals);

/// The same of random scenes alone: in a file of its own.
void run_random_command(const BatteryCommand& command, const Globals& globals);

}  // namespace palpate::cli
