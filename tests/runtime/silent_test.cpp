// SPDX-License-Identifier: GPL-3.0-or-later
// No system call in a tick: a program that the kernel kills for one.
#include <gtest/gtest.h>

#include <csignal>
#include <string>

#include "tests/support/run_program.hpp"

namespace palpate::test {
namespace {

// A hundred thousand ticks and more of every tool; 10: with grasps.
TEST(Promises, TicksMakeNoSystemCall) {
  for (const std::string name : {"separable", "search", "coupled_2", "coupled_4", "three_tools", "turn"}) {
    const RunResult run = run_program(PALPATE_SILENT_TICKS, {PALPATE_GOLDENS "/" + name + ".palp"});
    if (run.exit_code == 77) GTEST_SKIP() << run.error;
    EXPECT_EQ(run.exit_code, name == "turn" ? 10 : 0) << name << ": signal " << run.signal;
  }
}

TEST(Promises, ASystemCallInATickIsNoticed) {
  const RunResult run = run_program(PALPATE_SILENT_TICKS, {PALPATE_GOLDENS "/separable.palp", "call"});
  if (run.exit_code == 77) GTEST_SKIP() << run.error;
  EXPECT_EQ(run.signal, SIGSYS) << run.exit_code;
}

}  // namespace
}  // namespace palpate::test
