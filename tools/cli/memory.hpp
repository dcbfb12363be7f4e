// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps memory that a solver frees, because the next step allocates as much again.
#pragma once

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace palpate::cli {

/// To be called first in main. A step of a contact's solve frees and allocates tens of MB of matrices; glibc would give
/// them back to the system each time, which then has to clear every page anew: a third of a solve.
inline void keep_freed_memory() {
#if defined(__GLIBC__)
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most it takes
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  mallopt(M_TOP_PAD, 16 << 20);
#endif
}

}  // namespace palpate::cli
