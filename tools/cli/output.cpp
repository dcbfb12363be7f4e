// SPDX-License-Identifier: GPL-3.0-or-later
// Printing with its failures reported: a full disk behind a redirection must not look like success.
#include "tools/cli/output.hpp"

#include "formats/io/error.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

namespace palpate::cli {

void print(const std::string& text) {
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!written || std::fflush(stdout) != 0) {
    throw Error(ExitCode::io, std::string("standard output: cannot write the result: ") + std::strerror(errno));
  }
}

void print_json(const nlohmann::ordered_json& document) {
  // Names of meshes and files may hold bytes that are not UTF-8: they are replaced, not refused.
  print(document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

void note(const Globals& globals, const std::string& line) {
  if (!globals.quiet) std::fprintf(stderr, "%s\n", line.c_str());
}

void warn(const std::string& line) { std::fprintf(stderr, "palpate: warning: %s\n", printable(line).c_str()); }

std::string counted(std::size_t count, const char* one, const char* others) {
  const std::string number = std::to_string(count) + " ";
  if (count == 1) return number + one;
  return others != nullptr ? number + others : number + one + "s";
}

std::string shell_word(const std::string& text) {
  if (!text.empty() && text.find_first_of(" \t\n'\"\\$&;()<>|*?[]#~`!") == std::string::npos) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

void check_writable(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  std::error_code error;
  int cause = std::filesystem::is_directory(file, error) ? EISDIR : 0;
  if (cause == 0 && ::access(folder.c_str(), W_OK | X_OK) != 0) cause = errno;
  if (cause == 0 && !std::filesystem::is_directory(folder, error)) cause = ENOTDIR;
  if (cause != 0) throw Error(ExitCode::io, file.string() + ": cannot be written: " + std::strerror(cause));
}

}  // namespace palpate::cli
