// SPDX-License-Identifier: GPL-3.0-or-later
// How a fuzz target reports a broken invariant.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace palpate::test {

/// Prints an invariant that does not hold and ends the program, as a sanitizer does.
inline void expect(bool good, const char* invariant) {
  if (good) return;
  std::fprintf(stderr, "broken invariant: %s\n", invariant);
  std::abort();
}

}  // namespace palpate::test
