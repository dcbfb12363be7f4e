// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate bench --solver`: curve sets an hour against their error.
#pragma once

#include "tools/cli/commands.hpp"

#include <string>

namespace palpate::cli {

struct SolverBenchCommand {
  std::string scene;  ///< empty: a block of 60 x 60 x 30 mm under a sphere of 5 mm, 5 mm deep, friction 0.3
  int contacts = 1;   ///< of the scene's plan, spread evenly over it
};

/// Prints a row a mesh setting. Throws as the pipeline does.
void run_solver_bench(const SolverBenchCommand& command, const Globals& globals);

}  // namespace palpate::cli
