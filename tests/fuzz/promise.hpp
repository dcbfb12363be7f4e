// SPDX-License-Identifier: GPL-3.0-or-later
// How a fuzz target says that a promise is broken.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace palpate::test {

/// The promise is broken: says which and ends the program, as a sanitizer does.
inline void expect(bool good, const char* promise) {
  if (good) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

}  // namespace palpate::test
