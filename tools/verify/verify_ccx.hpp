// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify --compare ccx`: forces and times beside CalculiX'.
#pragma once

#include "tools/cli/commands.hpp"

#include <string>

namespace palpate::cli {

struct CcxCommand {
  std::string report;  ///< JSON file; empty: none
  std::string cases;   ///< only those whose name has this in it; empty: all
};

/// Prints forces on the same mesh and against a finer one, what the tool's facets and the contact's stiffness do to
/// them, and both programs' errors against their times. Throws Error(io) where there is no ccx, Error(numerical) where
/// a solve was refused, Error(tolerance) where a finer setting changes a force by more than 0.25 %, where forces differ
/// by more than 1 % (same mesh) or 2 % (finer mesh), or where ours is not 40 times as fast at equal error.
void run_ccx_command(const CcxCommand& command, const Globals& globals);

}  // namespace palpate::cli
