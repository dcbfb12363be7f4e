// SPDX-License-Identifier: GPL-3.0-or-later
// The palpate executable in a folder of the test's own, and what is expected of a failure.
#pragma once

#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <set>
#include <sstream>

namespace palpate::test {

class PalpateProgram : public testing::Test {
protected:
  /// Runs `palpate` inside folder().
  RunResult run(const std::vector<std::string>& arguments, RunOptions options = {}) const {
    options.folder = folder_.path();
    return run_program(PALPATE_PROGRAM, arguments, options);
  }

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    return folder_.write(name, content);
  }

  TemporaryFolder folder_;
};

/// Ends with the code, no signal, in time, with "palpate: error: " and every part of `cause` on standard error and
/// nothing on standard output.
inline void expect_failure(const RunResult& result, int code, const std::vector<std::string>& cause) {
  EXPECT_FALSE(result.timed_out) << "it hung";
  EXPECT_EQ(result.signal, 0) << "it crashed";
  EXPECT_EQ(result.exit_code, code) << result.error;
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.error.find("palpate: error: "), std::string::npos) << result.error;
  for (const std::string& part : cause) {
    EXPECT_NE(result.error.find(part), std::string::npos) << "expected: " << part << "\ngot: " << result.error;
  }
}

/// Names of the commands that `--help` lists.
inline std::set<std::string> listed_commands() {
  std::istringstream help(run_program(PALPATE_PROGRAM, {"--help"}).out);
  std::set<std::string> names;
  std::string line;
  while (std::getline(help, line) && line.rfind("Subcommands:", 0) != 0) {
  }
  while (std::getline(help, line) && line.rfind("  ", 0) == 0) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    if (line[2] != ' ') names.insert(name);
  }
  return names;
}

/// A test name of letters, digits and underscores.
inline std::string test_name(const std::string& text) {
  std::string name;
  for (const char c : text) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

}  // namespace palpate::test
