// SPDX-License-Identifier: MIT
// What the system grants a thread that must not be late.
#pragma once

#include <string>

namespace palpate::device {

struct RealtimeOptions {
  int priority = 80;        ///< of SCHED_FIFO, [1, 98]; 0: the usual scheduling
  int core = -1;            ///< the processor to stay on; -1: any
  bool lock_memory = true;  ///< keep what is mapped now in memory

  /// Null, or what is wrong.
  [[nodiscard]] const char* validate() const;
};

struct Realtime {
  bool fifo = false, pinned = false, locked = false;  ///< what was asked for and granted
  std::string refused;                                ///< what was not, and why; empty: nothing
};

/// Asks for the calling thread, and memory for the whole process. What is refused is left out: the thread runs as it
/// did.
Realtime make_realtime(const RealtimeOptions& options);

/// Memory may leave again.
void release_memory();

}  // namespace palpate::device
