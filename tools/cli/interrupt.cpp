// SPDX-License-Identifier: GPL-3.0-or-later
// Signal handlers: only async-signal-safe work happens in them.
#include "tools/cli/interrupt.hpp"

#include <unistd.h>
#include <atomic>

namespace palpate::cli {

namespace {

std::atomic<int> pending_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void on_signal(int signal) {
  if (pending_signal.exchange(signal, std::memory_order_relaxed) != 0) _exit(128 + signal);
}

}  // namespace

InterruptPolling::InterruptPolling() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, &interrupt_);
  sigaction(SIGTERM, &action, &terminate_);
}

InterruptPolling::~InterruptPolling() {
  sigaction(SIGINT, &interrupt_, nullptr);
  sigaction(SIGTERM, &terminate_, nullptr);
}

bool interrupted() noexcept { return pending_signal.load(std::memory_order_relaxed) != 0; }

int interrupt_exit_code() noexcept { return 128 + pending_signal.load(std::memory_order_relaxed); }

}  // namespace palpate::cli
