// SPDX-License-Identifier: GPL-3.0-or-later
// palpate fit --measured: a file from a recording alone, its report, and the recordings that it refuses.
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/cli/palpate_program.hpp"

namespace palpate::test {
namespace {

class Measured : public PalpateProgram {
protected:
  Measured() {
    write("slab.off",
          "OFF\n8 12 0\n-.03 -.03 0\n.03 -.03 0\n-.03 .03 0\n.03 .03 0\n-.03 -.03 .02\n.03 -.03 .02\n-.03 .03 .02\n"
          ".03 .03 .02\n3 0 2 1\n3 1 2 3\n3 4 5 6\n3 5 7 6\n3 0 1 4\n3 1 5 4\n3 2 6 3\n3 3 6 7\n3 0 4 2\n3 2 4 6\n"
          "3 1 3 5\n3 3 7 5\n");
    write("slab.toml",
          "[body]\nsurface = \"slab.off\"\n[sampling]\nspacing = 0.02\ndepth = 0.002\n[sources]\nrest = \"filled\"\n");
  }

  /// Pushes down the middle of the top; every tenth row is a spike.
  static std::string recording() {
    std::string text = "x,y,z,dx,dy,dz,fx,fy,fz\n";
    for (int k = 1; k <= 50; ++k) {
      char line[160];
      std::snprintf(line, sizeof line, "0,0,0.02,0,0,%.6g,0,0,%.6g\n", -4e-5 * k,
                    k % 10 == 5 ? 5.0 : 0.5 * std::pow(k / 50.0, 1.5));
      text += line;
    }
    return text;
  }
};

TEST_F(Measured, ARecordingAloneMakesAFile) {
  write("press.csv", recording());
  const RunResult result = run({"fit", "--measured", "press.csv", "slab.toml", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["pairs_planned"], 0);
  ASSERT_EQ(json["measured"].size(), 1U);
  EXPECT_EQ(json["measured"][0]["rows"], 50);
  EXPECT_EQ(json["measured"][0]["outliers"],
            nlohmann::json({"press.csv:6", "press.csv:16", "press.csv:26", "press.csv:36", "press.csv:46"}));
  EXPECT_LT(json["measured"][0]["residual_rms_N"].get<double>(), 0.005);
  const auto inspected = nlohmann::json::parse(run({"inspect", "slab.palp", "--json"}).out);
  EXPECT_EQ(inspected["responses_measured"], 1);
  EXPECT_EQ(inspected["responses_solved"], 0);
  EXPECT_EQ(inspected["responses_filled"].get<int>() + 1, inspected["responses"].get<int>());
  const RunResult text = run({"fit", "slab.toml", "--measured", "press.csv"});
  EXPECT_NE(text.out.find("50 rows down to 2 mm, residual "), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("5 left out as outliers: press.csv:6, press.csv:16"), std::string::npos) << text.out;
}

TEST_F(Measured, WhatIsPassedOverIsTold) {
  write("press.csv", recording() + "0,0,0.02,0,0,0.001,0,0,0\n0,0,0.02,0,0,-0.003,0,0,1\n");
  const RunResult json = run({"fit", "slab.toml", "--measured", "press.csv", "--json"});
  ASSERT_EQ(json.exit_code, 0) << json.error;
  EXPECT_NE(json.error.find("build and verify read the recordings that the scene names"), std::string::npos);
  const auto passed = nlohmann::json::parse(json.out)["measured"][0]["passed_over"];
  EXPECT_EQ(passed["not_in_contact"], 1);
  EXPECT_EQ(passed["too_deep"], 1);
  const RunResult text = run({"fit", "slab.toml", "--measured", "press.csv"});
  EXPECT_NE(text.out.find("; 2 rows passed over: 1 not in contact, 1 deeper than"), std::string::npos) << text.out;
}

TEST_F(Measured, PlanAndVerifyKnowWhatIsNotSolved) {
  write("press.csv", recording());
  const std::string scene =
      "[body]\nsurface = \"slab.off\"\n[sampling]\nspacing = 0.02\ndepth = 0.002\n[sources]\nrest = \"filled\"\n"
      "[[measured]]\nfile = \"press.csv\"\n";
  write("slab.toml", scene);
  const auto plan = nlohmann::json::parse(run({"plan", "slab.toml", "--json"}).out);
  EXPECT_EQ(plan["pairs_planned"], 0);
  EXPECT_EQ(plan["pairs_measured"], 1);
  EXPECT_GT(plan["pairs_filled"], 1);
  // The file is opened after the journal, which nobody asks for.
  const RunResult verified = run({"verify", "slab.toml", "--response", "none.palp"});
  expect_failure(verified, 4, {"none.palp"});
  EXPECT_EQ(verified.error.find("journal"), std::string::npos) << verified.error;
  write("friction.toml", scene + "[contact]\nfriction = 0.3\n");
  expect_failure(run({"bench", "--models", "friction.toml"}), 2, {"friction.toml: no pair of it was solved"});
}

TEST_F(Measured, WithoutABakeTheOtherSitesMayBeCovered) {
  write("press.csv", recording());
  write("solved.toml", "[body]\nsurface = \"slab.off\"\n[sampling]\nspacing = 0.02\ndepth = 0.002\n");
  expect_failure(run({"fit", "solved.toml", "--measured", "press.csv"}), 4,
                 {"no journal", "or take the other sites from their neighbours: [sources] rest = \"filled\""});
}

TEST_F(Measured, BadRecordingsEndWithTwo) {
  write("bad.csv", recording() + "0,0,0.02,0,0,deep,0,0,1\n");
  expect_failure(run({"fit", "slab.toml", "--measured", "bad.csv"}), 2, {"bad.csv:52: column dz: got 'deep'"});
  const std::string whole = recording();
  write("late.csv", whole.substr(0, whole.find('\n') + 1) + whole.substr(whole.find("0,0,0.02,0,0,-0.0004,")));
  expect_failure(run({"fit", "slab.toml", "--measured", "late.csv"}), 2,
                 {"late.csv:2: recorded pair", "no row between the depths 0 and 0.4 mm; record one there"});
  write("away.csv", "x,y,z,dx,dy,dz,fx,fy,fz\n0,0,0.05,0,0,-0.001,0,0,1\n");
  expect_failure(run({"fit", "slab.toml", "--measured", "away.csv"}), 2, {"away.csv:2: the contact lies 30 mm off"});
  expect_failure(run({"fit", "slab.toml", "--measured", "none.csv"}), 4, {"none.csv"});
  expect_failure(run({"fit", "slab.toml"}), 2, {"needs a recording"});
}

}  // namespace
}  // namespace palpate::test
