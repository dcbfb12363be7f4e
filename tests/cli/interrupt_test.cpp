// SPDX-License-Identifier: GPL-3.0-or-later
// Ctrl-C: a bake stops with what it solved, says so, and the next one goes on from there.
#include "tests/cli/palpate_program.hpp"

#include <nlohmann/json.hpp>

namespace palpate::test {
namespace {

class Interrupt : public PalpateProgram {};

TEST_F(Interrupt, ABakeStopsAndGoesOn) {
  // Four sites of a small frictionless slab.
  ASSERT_EQ(run({"synth", "slab", "--out", ".", "--scale", "0.5", "--friction", "0", "--tool-radius", "0.003",
                 "--depth", "0.001", "--spacing", "0.03"})
                .exit_code,
            0);
  const RunResult stopped =
      run({"bake", "scene.toml", "--quiet"}, {.time_limit = 120, .interrupt = std::chrono::milliseconds(1000)});
  EXPECT_FALSE(stopped.timed_out);
  EXPECT_EQ(stopped.exit_code, 130) << stopped.error;
  EXPECT_NE(stopped.error.find("interrupted: "), std::string::npos) << stopped.error;
  const RunResult again = run({"bake", "scene.toml", "--quiet", "--json"}, {.time_limit = 240});
  ASSERT_EQ(again.exit_code, 0) << again.error;
  const auto report = nlohmann::json::parse(again.out);
  EXPECT_EQ(report.at("pairs_accepted"), report.at("pairs_planned"));
  EXPECT_EQ(report.at("tangential_solves"), 0);
}

}  // namespace
}  // namespace palpate::test
