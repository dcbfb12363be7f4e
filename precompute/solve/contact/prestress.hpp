// SPDX-License-Identifier: GPL-3.0-or-later
// The body as its own loads leave it: what sites are placed on and tools come to.
#pragma once

#include "precompute/common/body.hpp"

namespace palpate::solve {

/// Solves the prestress of a stress-free body, on a mesh that is even over its surface, and moves its surfaces along;
/// a line of the report says how far. A body without prestress is handed back as it is. Deterministic.
/// Throws Error(bad_input) where pressure finds no cavity, Error(numerical) where the full loads have no equilibrium
/// (it names the share that has one), where the body cannot be meshed, and where the moved surface crosses itself.
Body apply_prestress(Body body);

}  // namespace palpate::solve
