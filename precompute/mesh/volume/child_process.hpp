// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a helper program: bytes in, bytes out, limits, and never a signal or a zombie for the caller.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::mesh {

/// Time and memory that a child may use before it is killed.
struct ChildLimits {
  double cpu_time = 60.0;                      ///< s of processor time, rounded up to whole seconds
  std::size_t memory = std::size_t{4} << 30U;  ///< bytes of address space; 0: no limit
  std::size_t output = std::size_t{1} << 31U;  ///< bytes
};

/// How a child is started.
struct ChildStart {
  std::vector<std::string> arguments;    ///< beyond the program's name
  std::filesystem::path folder;          ///< its working folder; empty: ours
  std::vector<std::string> environment;  ///< "NAME=value", beside our own variables or in their place
};

struct ChildResult {
  bool finished = false;     ///< ended by itself with exit status 0
  std::string cause;         ///< why not: a limit reached, signal, exit status
  std::vector<char> output;  ///< its standard output
  std::string messages;      ///< the last 4 KB of its standard error
  double cpu_time = 0.0;     ///< s of processor time, of one that ended by itself
};

/// Starts `program` in a process group of its own (a terminal's Ctrl-C passes it by), feeds
/// `input`, and reads until it ends. It is killed at its limits, and as a last resort (it may be asleep) after ten
/// times its processor time by the clock, which stands still while the caller is stopped. Safe to call from several
/// threads. Throws Error(io) naming `program` where it cannot be started or spoken to.
ChildResult run_child(const std::filesystem::path& program, const std::vector<char>& input, const ChildLimits& limits,
                      const ChildStart& start = {});

/// Path of an installed or freshly built helper of this name: beside the running executable, or in
/// ../libexec/palpate. Empty when in neither.
std::filesystem::path find_helper(const std::string& name);

}  // namespace palpate::mesh
