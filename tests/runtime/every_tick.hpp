// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that a force loop may call.
#pragma once

#include <cstddef>

namespace palpate::test {

struct EveryTick {
  const char* error = nullptr;    ///< why the file could not be opened
  long touching = 0, bonded = 0;  ///< ticks with a force, of contacts and of bonded contacts
  bool finite = true;
};

/// Opens the bytes and ticks every tool `ticks` times along a varied motion: contacts and sets that search and that are given
/// searches, on bodies that are still, move, deform and change their stiffness, bonded and coupled ones, with every step of
/// an output behind them. Calls `halfway` once on the way.
EveryTick every_tick(const void* bytes, std::size_t size, int ticks, void (*halfway)());

}  // namespace palpate::test
