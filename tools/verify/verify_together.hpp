// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify --together`: the runtime's forces of tools beside each other against solves of all of them at once.
#pragma once

#include "tools/cli/commands.hpp"

#include <string>
#include <vector>

namespace palpate::cli {

struct TogetherCommand {
  std::string scene;                              ///< empty: a block, shallow enough for Hertz' law
  std::string response;                           ///< of the scene; empty: NAME.palp beside it
  std::string report;                             ///< also write the JSON there; empty: no
  int count = 2;                                  ///< tools, [2, 5]
  std::string layout = "line";                    ///< how they lie: "line", "ring", "pinch" (2 tools), "random"
  int contacts = 3;                               ///< of the scene's plan, spread evenly over it
  double aside = 0;       ///< of the first tool once all are down, in depths; the scene needs friction
  double max_p95 = 0.05;  ///< of the error, beyond which the command fails; not of a line on the block
};

/// Prints a row a contact and spacing: the forces of solves, of the runtime, and of single contacts added. Spacings, in
/// contact radii: line 1, 1.5, 2, 4, 8; ring 1.5, 2, 3; random eight draws from 1 to 8. A pinch without a scene has
/// slabs of 10, 20 and 40 mm. Throws Error(tolerance) for a line on the block beyond 6 % at one contact radius, 2 %
/// at 1.5 and 1 % from 2 on, else beyond max_p95; Error(bad_input) where the response file has no compliance;
/// Error(numerical) where no solve is usable.
void run_together(const TogetherCommand& command, const Globals& globals);

}  // namespace palpate::cli
