// SPDX-License-Identifier: MIT
#include "device/loop/realtime.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

namespace palpate::device {

const char* RealtimeOptions::validate() const {
  if (priority < 0 || priority > 98) return "the priority is outside 0 to 98";
  if (core < -1 || core >= CPU_SETSIZE) return "there is no such core";
  return nullptr;
}

Realtime make_realtime(const RealtimeOptions& options) {
  Realtime granted;
  const auto refuse = [&](const std::string& what, int error) {
    granted.refused += (granted.refused.empty() ? "" : "; ") + what + ": " + std::strerror(error);
  };
  if (options.core >= 0) {
    cpu_set_t cores;
    CPU_ZERO(&cores);
    CPU_SET(static_cast<std::size_t>(options.core), &cores);
    const int error = ::pthread_setaffinity_np(::pthread_self(), sizeof cores, &cores);
    granted.pinned = error == 0;
    if (error != 0) refuse("core " + std::to_string(options.core), error);
  }
  // Now and not later mappings: the loop makes none, and other threads must not be refused memory for its sake.
  if (options.lock_memory) {
    granted.locked = ::mlockall(MCL_CURRENT) == 0;
    if (!granted.locked) refuse("locked memory", errno);
  }
  if (options.priority > 0) {
    const sched_param parameters{options.priority};
    const int error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
    granted.fifo = error == 0;
    if (error != 0) refuse("real-time priority", error);
  }
  return granted;
}

void release_memory() { ::munlockall(); }

}  // namespace palpate::device
