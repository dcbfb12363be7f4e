// SPDX-License-Identifier: MIT
// The one error type of the project and the exit codes that users script against.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace palpate {

/// Exit codes of the command line; every thrown Error carries the one it ends with.
enum class ExitCode : int {
  done = 0,
  usage = 1,      ///< wrong command-line usage
  bad_input = 2,  ///< a file's content is wrong: scene, surface, motion, journal, response
  numerical = 3,  ///< a solve, mesh or fit could not be brought to a result that passes its gates
  io = 4,         ///< the system refused: cannot open, write, rename; disk full
  tolerance = 5,  ///< a result lies outside the required tolerance
};

/// An error that a user can act on: says what, where (file, line or element) and the allowed range.
class Error : public std::runtime_error {
public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] ExitCode code() const noexcept { return code_; }

private:
  ExitCode code_;
};

}  // namespace palpate
