// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify --paper FOLDER`: figures 2 and 4 of Hayward and Mahvash (2004).
#pragma once

#include "tools/cli/commands.hpp"

#include <string>

namespace palpate::cli {

struct PaperCommand {
  std::string folder;  ///< gets scenes and plots; created when missing
  std::string report;  ///< JSON file; empty: none
};

/// Writes the scenes, solves them, writes paper-figure-2.svg and paper-figure-4.svg, and prints what the paper says
/// with the figures found. Throws Error(tolerance) where a statement does not hold.
void run_paper_command(const PaperCommand& command, const Globals& globals);

}  // namespace palpate::cli
