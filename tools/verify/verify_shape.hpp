// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify --shape`: the drawn dent against the surface of solves.
#pragma once

#include "tools/cli/commands.hpp"

#include <string>

namespace palpate::cli {

struct ShapeCommand {
  std::string scene;       ///< empty: the block of --together
  std::string response;    ///< of the scene; empty: NAME.palp beside it
  std::string report;      ///< also write the JSON there; empty: no
  int contacts = 3;        ///< of the scene's plan, spread evenly over it
  double max_p95 = 0.03;   ///< of the depth: 95th percentile from 1.5 to 8 contact radii
  double max_worst = 0.1;  ///< of the depth: worst node within 1.5 contact radii
};

/// Presses one tool, and two at 2 and 4 contact radii, and compares the solved surface's nodes with runtime::Dent by
/// the runtime's own forces. Throws Error(tolerance) beyond a limit; Error(bad_input) where the response file has no
/// compliance; Error(numerical) where no solve is usable.
void run_shape(const ShapeCommand& command, const Globals& globals);

}  // namespace palpate::cli
