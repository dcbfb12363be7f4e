// SPDX-License-Identifier: MIT
// Real-time priority, processor affinity and locked memory for a thread that must not be late.
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
  bool fifo = false, pinned = false, locked = false;  ///< requests that were granted
  std::string refused;                                ///< refused requests, and why; empty: none
};

/// Requests priority and affinity for the calling thread, and locked memory for the whole process. A refused request
/// changes nothing.
Realtime make_realtime(const RealtimeOptions& options);

/// Memory may leave again.
void release_memory();

}  // namespace palpate::device
