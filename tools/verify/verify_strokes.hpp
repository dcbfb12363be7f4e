// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify --strokes`: what the runtime answers along a motion against a solve of the whole motion.
#pragma once

#include "tools/cli/commands.hpp"

#include <string>

namespace palpate::cli {

struct StrokesCommand {
  std::string scene, work, response;  ///< work, response: empty for the places beside the scene
  std::string report;                 ///< also write the JSON there; empty: no
  std::string plot;                   ///< also draw the strokes of the first contact there (SVG); empty: no
  int contacts = 3;                   ///< of the scene's plan, spread evenly over it
};

/// Solves the standard strokes at a few contacts with Coulomb friction, plays them against the scene's response file
/// and prints the errors apart for what the solve says of the contact: sticking, slipping in part, sliding. Throws
/// Error(numerical) where no stroke was solved to its end.
void run_strokes(const StrokesCommand& command, const Globals& globals);

}  // namespace palpate::cli
