// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a helper program: bytes in, bytes out, a time limit, and never a signal or a zombie for the caller.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

struct ChildResult {
  bool finished = false;     ///< ended by itself with exit status 0
  std::string cause;         ///< why not: could not start, time limit, signal, exit status
  std::vector<char> output;  ///< its standard output
  std::string messages;      ///< the last 4 KB of its standard error
};

/// Starts `program` without arguments in a process group of its own (a terminal's Ctrl-C passes it by), feeds
/// `input`, and reads until it ends. It is killed after `time_limit` s or `most_output` bytes. Safe to call from
/// several threads.
ChildResult run_child(const std::filesystem::path& program, const std::vector<char>& input, double time_limit,
                      std::size_t most_output);

/// Where an installed or freshly built helper of this name is: beside the running executable, or in
/// ../libexec/palpate. Empty when in neither.
std::filesystem::path find_helper(const std::string& name);

}  // namespace palpate
