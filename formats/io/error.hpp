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

/// The text with its control characters as "\\x1B", because a terminal obeys them and a C string ends at the first 0.
/// Newlines, tabs and UTF-8 stay.
inline std::string printable(const std::string& text) {
  std::string result;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto c = static_cast<unsigned char>(text[k]);
    const auto next = static_cast<unsigned char>(k + 1 < text.size() ? text[k + 1] : 0);
    const bool control = (c < 0x20 && c != '\n' && c != '\t') || c == 0x7F;
    const bool control_utf8 = c == 0xC2 && next >= 0x80 && next < 0xA0;
    if (!control && !control_utf8) {
      result += text[k];
      continue;
    }
    constexpr const char* kDigits = "0123456789ABCDEF";
    const unsigned char value = control ? c : next;
    result += {'\\', 'x', kDigits[value >> 4U], kDigits[value & 0xFU]};
    if (control_utf8) ++k;
  }
  return result;
}

/// An error that a user can act on: says what, where (file, line or element) and the allowed range, printable.
class Error : public std::runtime_error {
public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(printable(message)), code_(code) {}
  [[nodiscard]] ExitCode code() const noexcept { return code_; }

private:
  ExitCode code_;
};

}  // namespace palpate
