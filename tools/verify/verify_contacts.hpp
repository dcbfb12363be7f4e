// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify --slide` and `palpate verify --two-tips`: solves that the runtime is judged against.
#pragma once

#include "tools/cli/commands.hpp"

#include <string>

namespace palpate::cli {

struct ContactsCommand {
  std::string scene;   ///< empty: a block, shallow enough for Coulomb's and Hertz' laws
  std::string report;  ///< also write the JSON there; empty: no
  int contacts = 3;    ///< of the scene's plan, spread evenly over it
  double radii = 3.5;  ///< length of the slides in contact radii
};

/// Prints a row a slide and the transition to full slip. Throws Error(tolerance) where a slide is off Coulomb's law by
/// more than 2 %: point by point, and on the block also in its force ratio; Error(numerical) where none is usable.
void run_slide(const ContactsCommand& command, const Globals& globals);

/// Prints a row a contact and spacing. Throws Error(numerical) where none is usable.
void run_two_tips(const ContactsCommand& command, const Globals& globals);

}  // namespace palpate::cli
