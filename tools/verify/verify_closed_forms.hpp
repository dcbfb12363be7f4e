// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify --closed-forms`: the solver beside Hertz, Sneddon, Dimitriadis, Mindlin and Cattaneo.
#pragma once

#include "tools/cli/commands.hpp"

#include <string>

namespace palpate::cli {

struct ClosedFormsCommand {
  std::string report;  ///< JSON file; empty: none
};

/// Solves every law on bodies of two sizes and prints solved over law. Throws Error(tolerance) where one does not hold.
void run_closed_forms(const ClosedFormsCommand& command, const Globals& globals);

}  // namespace palpate::cli
