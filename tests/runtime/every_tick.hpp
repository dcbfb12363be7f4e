// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that a force loop may call.
#pragma once

#include <cstddef>

namespace palpate::test {

struct EveryTick {
  const char* error = nullptr;  ///< why the file could not be opened
  long touching = 0, held = 0;  ///< ticks with a force: of contacts, and of grasps
  bool finite = true;
};

/// Opens the bytes and ticks every tool `ticks` times along a varied motion: contacts that search and contacts that are
/// served, moving, animated, adjusted, grasping and coupled ones, with every step of an output behind them. Calls
/// `halfway` once on the way.
EveryTick every_tick(const void* bytes, std::size_t size, int ticks, void (*halfway)());

}  // namespace palpate::test
