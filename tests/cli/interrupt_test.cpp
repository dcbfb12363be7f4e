// SPDX-License-Identifier: GPL-3.0-or-later
// Ctrl-C: a bake stops with what it solved, says so, and the next one goes on from there; what cannot be saved ends.
#include "tests/cli/palpate_program.hpp"
#include "tests/support/response_samples.hpp"

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

namespace palpate::test {
namespace {

class Interrupt : public PalpateProgram {
protected:
  // A shell that runs the tests in the background has them ignore it, and so would the programs they start.
  void SetUp() override { std::signal(SIGINT, SIG_DFL); }
};

TEST_F(Interrupt, ABakeStopsAndGoesOn) {
  // Sites of a small frictionless slab.
  ASSERT_EQ(run({"synth", "slab", "--out", ".", "--scale", "0.5", "--friction", "0", "--tool-radius", "0.003",
                 "--depth", "0.001", "--spacing", "0.02"})
                .exit_code,
            0);
  std::ofstream(folder() / "scene.toml", std::ios::app) << "normal_points = 4\n[solver]\nmesh_size = 1\n";
  // Interrupted a little later each time, until one pair is solved; there are more than two.
  RunResult stopped;
  for (auto wait = std::chrono::milliseconds(500);; wait = wait * 3 / 2) {
    stopped = run({"bake", "scene.toml", "--quiet", "--threads", "1"}, {.time_limit = 240, .interrupt = wait});
    ASSERT_FALSE(stopped.timed_out);
    // Before the first solve there is nothing to save, and the signal ends the program.
    if (stopped.signal == SIGINT) continue;
    ASSERT_EQ(stopped.exit_code, 130) << stopped.error;
    ASSERT_NE(stopped.error.find("interrupted: "), std::string::npos) << stopped.error;
    if (stopped.error.find("interrupted: 0 of ") == std::string::npos) break;
  }
  const RunResult again = run({"bake", "scene.toml", "--quiet", "--json"}, {.time_limit = 240});
  ASSERT_EQ(again.exit_code, 0) << again.error;
  const auto report = nlohmann::json::parse(again.out);
  EXPECT_EQ(report.at("pairs_accepted"), report.at("pairs_planned"));
  EXPECT_EQ(report.at("tangential_solves"), 0);
  EXPECT_GT(report.at("pairs_resumed"), 0);
  EXPECT_LT(report.at("pairs_resumed"), report.at("pairs_planned"));
}

TEST_F(Interrupt, CommandsThatKeepNoSolvesEndAtOnce) {
  write_response_file(folder() / "ball.palp", encode(ball_content()));
  const std::vector<std::string> commands[] = {{"bench", "ball.palp", "--contacts", "1000", "--seconds", "10"},
                                               {"verify", "--battery", "random", "--count", "1"}};
  for (const auto& command : commands) {
    const RunResult result = run(command, {.time_limit = 8, .interrupt = std::chrono::milliseconds(1000)});
    EXPECT_FALSE(result.timed_out) << command[0] << ": Ctrl-C did nothing";
    EXPECT_EQ(result.signal, SIGINT) << result.error;
  }
}

}  // namespace
}  // namespace palpate::test
