// SPDX-License-Identifier: GPL-3.0-or-later
// Ctrl-C and SIGTERM: the first signal makes a command that polls save and stop, the second ends it at once. Any other
// command is ended by the first signal, as every program is.
#pragma once

#include <csignal>
#include <stdexcept>
#include <string>

namespace palpate::cli {

/// While it lives, SIGINT and SIGTERM only set interrupted(): for work that polls it. Before and after they do what
/// they did. One at a time.
class InterruptPolling {
public:
  InterruptPolling();
  ~InterruptPolling();
  InterruptPolling(const InterruptPolling&) = delete;
  InterruptPolling& operator=(const InterruptPolling&) = delete;

private:
  struct sigaction interrupt_ = {}, terminate_ = {};  // what they did before
};

/// True once a signal requested a stop. Safe from any thread, costs one relaxed load.
bool interrupted() noexcept;

/// The process's exit code after an interruption: 128 + the signal's number, as shells have it.
int interrupt_exit_code() noexcept;

/// Thrown by a command that stopped because interrupted() became true and has saved what it had.
class Interrupted : public std::runtime_error {
public:
  /// `state`: what is kept and how to go on, e.g. "120 of 400 pairs are solved; run the command again".
  explicit Interrupted(const std::string& state) : std::runtime_error("interrupted: " + state) {}
};

}  // namespace palpate::cli
