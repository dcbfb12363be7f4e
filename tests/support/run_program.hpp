// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a program with a time limit and collects what it said: for tests of the command line.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate::test {

struct RunOptions {
  double time_limit = 120.0;       ///< s; beyond it the program is killed; long, for a machine that does much else
  std::filesystem::path folder{};  ///< working folder; empty: ours
  std::filesystem::path output{};  ///< standard output goes to this file; empty: it is collected
  std::vector<std::string> environment{};                ///< "NAME=value", added to ours
  std::optional<std::size_t> file_limit{};               ///< bytes that a file may have (RLIMIT_FSIZE)
  std::filesystem::path small_disk{};                    ///< a file system of 64 KiB is mounted here (needs root)
  std::optional<std::chrono::milliseconds> interrupt{};  ///< SIGINT after this time
};

struct RunResult {
  int exit_code = -1;      ///< of the program; -1 when it ended otherwise
  int signal = 0;          ///< that ended it
  bool timed_out = false;  ///< it was killed because of the time limit
  bool mounted = true;     ///< false: the small disk was requested and is not allowed here
  std::string out, error;  ///< what it wrote to standard output and standard error
};

/// Runs `program` (a path) with `arguments`. Throws std::runtime_error when it cannot be started.
RunResult run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                      const RunOptions& options = {});

}  // namespace palpate::test
