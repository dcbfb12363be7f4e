// SPDX-License-Identifier: MIT
// Signals as requests to a force loop, and what a program that crashes can still do for the hand.
#pragma once

#include "device/loop/stop_flags.hpp"

#include <csignal>
#include <memory>

namespace palpate::device {

/// While it lives: SIGINT and SIGTERM request a stop, and an emergency stop when they come again; SIGHUP, SIGQUIT,
/// SIGTSTP (a suspended program sends no zero) and SIGPIPE (unless it is ignored) request an emergency stop. SIGSEGV,
/// SIGBUS, SIGFPE, SIGILL and SIGABRT request an emergency stop, hold the thread that crashed for kHold, in which the
/// loop, or the staleness rule of the thread that speaks with the device, sends zero, call `last`, and then end the
/// program as they would have. If that thread itself crashed, only the device's own watchdog is left. One at a time;
/// `flags` must outlive it.
class StopSignals {
public:
  static constexpr long kHold = 200;  ///< ms; a thread that is not real-time may have to wait for its turn

  /// `last` is called in a signal handler: it does what is async-signal-safe (POSIX, signal-safety(7)) alone.
  explicit StopSignals(StopFlags& flags, void (*last)() = nullptr);
  ~StopSignals();  ///< all as before
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

private:
  static constexpr int kSignals[] = {SIGINT,  SIGTERM, SIGHUP, SIGQUIT, SIGTSTP, SIGPIPE,
                                     SIGSEGV, SIGBUS,  SIGFPE, SIGILL,  SIGABRT};

  struct sigaction before_[sizeof kSignals / sizeof kSignals[0]] = {};
  stack_t stack_before_ = {};
  std::unique_ptr<char[]> stack_;  // of the handler: a thread may crash because its own is full
};

}  // namespace palpate::device
