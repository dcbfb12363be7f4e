// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify --together`: the runtime's forces of tools beside each other against solves of all of them at once.
#pragma once

#include "tools/cli/command.hpp"

#include <string>
#include <vector>

namespace palpate::cli {

struct TogetherCommand {
  std::string scene;                              ///< empty: a block, shallow enough for Hertz' law
  std::string response;                           ///< of the scene; empty: NAME.palp beside it
  std::string report;                             ///< also write the JSON there; empty: no
  int count = 2;                                  ///< tools, 2
  std::string layout = "line";                    ///< how they lie: "line"
  int contacts = 3;                               ///< of the scene's plan, spread evenly over it
  std::vector<double> spacings{1, 1.5, 2, 4, 8};  ///< contact radii
  double max_p95 = 0.05;                          ///< of the error on a scene, beyond which the command fails
};

/// Prints a row a contact and spacing: the forces of solves, of the runtime, and of single contacts added. Throws
/// Error(tolerance) on the block beyond 6 % at one contact radius, 2 % at 1.5 and 1 % from 2 on, on a scene beyond
/// max_p95; Error(bad_input) where the response file has no compliance; Error(numerical) where no solve is usable.
void run_together(const TogetherCommand& command, const Globals& globals);

}  // namespace palpate::cli
