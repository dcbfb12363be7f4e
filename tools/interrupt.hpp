// SPDX-License-Identifier: GPL-3.0-or-later
// Ctrl-C and SIGTERM: the first asks the work to stop and save, the second ends the process at once.
#pragma once

#include <stdexcept>
#include <string>

namespace palpate::cli {

/// Installs the handlers for SIGINT and SIGTERM. Called once, by main.
void install_interrupt_handlers();

/// True once a signal asked the work to stop. Safe from any thread, costs one relaxed load.
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
