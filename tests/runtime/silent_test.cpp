// SPDX-License-Identifier: GPL-3.0-or-later
// No system call in a tick: the kernel kills the program for one.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "tests/support/run_program.hpp"

namespace palpate::test {
namespace {

// A hundred thousand ticks and more of every tool of every golden. Exit code 10: with bonded contacts.
TEST(SilentTicks, TicksMakeNoSystemCall) {
  int files = 0, bonded = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_GOLDENS)) {
    if (entry.path().extension() != ".palp") continue;
    const RunResult run = run_program(PALPATE_SILENT_TICKS, {entry.path().string()});
    if (run.exit_code == 77) GTEST_SKIP() << run.error;
    EXPECT_TRUE(run.exit_code == 0 || run.exit_code == 10)
        << entry << ": " << run.exit_code << ", signal " << run.signal;
    ++files;
    bonded += run.exit_code == 10;
  }
  EXPECT_GE(files, 10);
  EXPECT_EQ(bonded, 2);
}

TEST(SilentTicks, SystemCallInATickIsNoticed) {
  const RunResult run = run_program(PALPATE_SILENT_TICKS, {PALPATE_GOLDENS "/quadratic.palp", "call"});
  if (run.exit_code == 77) GTEST_SKIP() << run.error;
  EXPECT_EQ(run.signal, SIGSYS) << run.exit_code;
}

}  // namespace
}  // namespace palpate::test
