// SPDX-License-Identifier: GPL-3.0-or-later
// Counts what the calling thread does that a force loop may not: locks, waits, and calls of malloc.
#pragma once

namespace palpate::test {

/// Mutexes locked and conditions waited for, by this thread, in libraries too.
long locks_here();

/// Calls of malloc, calloc and realloc by this thread, in libraries too.
long mallocs_here();

}  // namespace palpate::test
