// SPDX-License-Identifier: GPL-3.0-or-later
// Shared behaviour of all commands: help, version, usage errors, output, the choice of BLAS kernels.
#include "tests/cli/palpate_program.hpp"
#include "tests/support/response_samples.hpp"
#include "tools/cli/blas.hpp"

#include <nlohmann/json.hpp>

namespace palpate::test {
namespace {

class Frame : public PalpateProgram {};

TEST_F(Frame, HelpAndVersion) {
  const RunResult help = run({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("Exit codes: 0 done, 1 wrong usage, 2 bad input"), std::string::npos);
  EXPECT_EQ(help.error, "");
  const RunResult version = run({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out.rfind("palpate 0.", 0), 0U) << version.out;
}

TEST_F(Frame, EveryCommandHasHelp) {
  const std::set<std::string> commands = listed_commands();
  const std::set<std::string> expected{"build",  "scene",   "mesh", "plan",  "bake",    "merge",  "submit", "fit",
                                       "verify", "inspect", "play", "drive", "compare", "export", "bench",  "synth",
                                       "report", "view"};
  EXPECT_EQ(commands, expected);
  for (const std::string& command : commands) {
    const RunResult help = run({command, "--help"});
    EXPECT_EQ(help.exit_code, 0) << command;
    EXPECT_NE(help.out.find("Usage: palpate " + command), std::string::npos) << help.out;
  }
}

TEST_F(Frame, WrongUsageEndsWithOne) {
  expect_failure(run({}), 1, {"subcommand is required"});
  expect_failure(run({"bakee"}), 1, {"unknown command 'bakee'", "synth"});
  expect_failure(run({"--frobnicate"}), 1, {"unknown option '--frobnicate'"});
  expect_failure(run({"scene"}), 1, {"scene is required"});
  expect_failure(run({"scene", "a", "b"}), 1, {"b"});
  expect_failure(run({"scene", "--reference", "a"}), 1, {"excludes"});
  expect_failure(run({"--threads", "0", "scene", "a"}), 1, {"--threads", "1"});
  expect_failure(run({"synth", "cow", "--out", "x"}), 1, {"cow", "liver"});
  expect_failure(run({"synth", "slab"}), 1, {"--out is required"});
  expect_failure(run({"synth", "slab", "--out", "x", "--poisson", "0.5"}), 1, {"--poisson", "0.4999"});
  expect_failure(run({"synth", "slab", "--out", "x", "--seed", "-1"}), 1, {"--seed"});
  expect_failure(run({"synth", "slab", "--out", "x", "--depth", "nan"}), 1, {"--depth"});
  expect_failure(run({"synth", "slab", "--out", "x", "--seed", "18446744073709551616"}), 1,
                 {"--seed", "got 18446744073709551616; allowed 0 to 18446744073709551615"});
  expect_failure(run({"export", "x.palp", "--tool-vertex", "4294967296"}), 1, {"--tool-vertex", "4294967295"});
  expect_failure(run({"synth", "slab", "--out", "x", "--inclusion-radius", "0.01"}), 1, {"--inclusion"});
  expect_failure(run({"synth", "slab", "--out", "x", "--inclusion", "--inclusion-radius", "0.9"}), 1, {"inclusion"});
  EXPECT_FALSE(std::filesystem::exists(folder() / "x"));
  for (const char* option : {"--max-p95", "--max-p95-tangential", "--max-refused-share"}) {
    expect_failure(run({"verify", "x.toml", option, "nan"}), 1, {option, "got nan; allowed [0, "});
  }
  expect_failure(run({"verify", "--slide", "--two-tips"}), 1, {"--slide", "exclude each other"});
  for (const std::vector<std::string>& kind : {std::vector<std::string>{"--slide"},
                                               {"--two-tips"},
                                               {"--together", "2"},
                                               {"--closed-forms"},
                                               {"--battery", "stiff"},
                                               {"--compare", "ccx"},
                                               {"--paper", "x"},
                                               {"x.toml", "--strokes"},
                                               {"x.palp", "--loops"},
                                               {"x.palp", "--device", "sim"}}) {
    std::vector<std::string> arguments{"verify", "--max-p95", "0.1"};
    arguments.insert(arguments.end(), kind.begin(), kind.end());
    expect_failure(run(arguments), 1, {"no limits to set", "--samples"});
  }
  expect_failure(run({"verify", "--strokes"}), 1, {"needs a scene"});
  expect_failure(run({"verify"}), 1, {"--strokes", "--loops", "--samples", "--device", "--battery"});
  expect_failure(run({"bench", "x.palp", "--work", "w"}), 1, {"--work belongs to --models"});
  expect_failure(run({"verify", "x.palp", "--loops", "--plot", "x.svg"}), 1, {"--plot", "--strokes"});
  expect_failure(run({"verify", "--together", "7"}), 1, {"--together"});
  expect_failure(run({"verify", "--slide", "--radii", "nan"}), 1, {"--radii", "got nan; allowed [0.1, 100]"});
  for (const char* other : {"--models", "--solver", "--rows", "--open"}) {
    expect_failure(run({"bench", "x.palp", other, "--plot", "x.svg"}), 1, {"--plot shows ticks", other});
  }
  expect_failure(run({"bench", "x.palp", "--seconds", "nan"}), 1, {"--seconds", "got nan; allowed [0.001, 10]"});
}

TEST_F(Frame, EveryDeviceOfDriveIsADeviceOfVerify) {
  if (listed_commands().count("drive") == 0) GTEST_SKIP() << "built without devices";
  for (const char* known : {"wooden-mbed", "wooden-teensy", "falcon", "woody", "sim-touch", "touch", "sim"}) {
    expect_failure(run({"verify", "none.palp", "--device", known}), 4, {"none.palp"});
  }
  expect_failure(run({"verify", "none.palp", "--device", "open-link"}), 1, {"open-link", "mechanics are not known"});
  expect_failure(run({"verify", "none.palp", "--device", "mouse"}), 1, {"falcon", "woody", "wooden-mbed"});
}

TEST_F(Frame, AFileOfAnotherKindIsNamed) {
  write_response_file(folder() / "ball.palp", encode(ball_content()));
  write("scene.toml", "[body]\nsurface = \"none.ply\"\n");
  for (const char* command : {"scene", "plan", "build"}) {
    expect_failure(run({command, "ball.palp"}), 2, {"ball.palp: is a response file; give its scene"});
  }
  for (const char* command : {"inspect", "bench"}) {
    expect_failure(run({command, "scene.toml"}), 2, {"scene.toml: ", "give the response file of this scene"});
  }
}

TEST_F(Frame, AToolThatIsNotThereIsRefusedWithoutARun) {
  if (listed_commands().count("view") == 0) GTEST_SKIP() << "built without a server";
  write_response_file(folder() / "ball.palp", encode(ball_content()));
  expect_failure(run({"view", "ball.palp", "--tool", "spoon", "--port", "0"}, {.time_limit = 20}), 2, {"'spoon'"});
}

TEST_F(Frame, GlobalOptionsStandAnywhere) {
  const RunResult before = run({"--json", "synth", "slab", "--out", "a"});
  const RunResult after = run({"synth", "slab", "--out", "a", "--json"});
  ASSERT_EQ(before.exit_code, 0) << before.error;
  EXPECT_EQ(before.out, after.out);
  const auto document = nlohmann::json::parse(before.out);
  EXPECT_EQ(document.at("scene"), "a/scene.toml");
  EXPECT_EQ(run({"synth", "slab", "--out", "a", "--quiet"}).error, "");
  EXPECT_NE(run({"synth", "slab", "--out", "a"}).error, "");
}

TEST_F(Frame, WhatIsListedIsListedAsJsonToo) {
  const auto json = [&](std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const RunResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return nlohmann::json::parse(result.out, nullptr, false);
  };
  EXPECT_EQ(json({"scene", "--reference"}).at("reference"), run({"scene", "--reference"}).out);
  const auto tissues = json({"scene", "--tissues"}).at("tissues");
  ASSERT_FALSE(tissues.empty());
  EXPECT_GT(tissues[0].at("shear_modulus").get<double>(), 0);
  if (listed_commands().count("drive") == 0) return;
  const auto devices = json({"drive", "--list"}).at("devices");
  ASSERT_FALSE(devices.empty());
  EXPECT_EQ(devices.back().at("state"), "simulated");
}

TEST_F(Frame, SynthSaysACommandThatAShellTakes) {
  EXPECT_NE(run({"synth", "slab", "--out", "it's a"}).error.find("build 'it'\\''s a/scene.toml'"), std::string::npos);
  EXPECT_NE(run({"synth", "slab", "--out", "a"}).error.find("build a/scene.toml\n"), std::string::npos);
}

TEST_F(Frame, ATumourIsAnInclusion) {
  const RunResult tumour = run({"synth", "liver", "--out", "a", "--tumour", "--inclusion-radius", "0.01"});
  EXPECT_EQ(tumour.exit_code, 0) << tumour.error;
  expect_failure(run({"synth", "slab", "--out", "b", "--tumour"}), 1, {"a tumour is the inclusion of a liver"});
}

TEST_F(Frame, TheReferenceIsAScene) {
  const RunResult reference = run({"scene", "--reference"});
  ASSERT_EQ(reference.exit_code, 0);
  write("FILE", "");
  write("all.toml", reference.out);
  const RunResult checked = run({"scene", "all.toml", "--json"});
  EXPECT_EQ(checked.exit_code, 0) << checked.error;
  EXPECT_EQ(nlohmann::json::parse(checked.out).at("name"), "all");
}

TEST_F(Frame, KernelsThatTheUserNamesAreKept) {
  const RunResult ours = run({"--version"});
  if (ours.out.find("OpenBLAS kernels: ") == std::string::npos) GTEST_SKIP() << "this build does not load OpenBLAS";
  const RunResult theirs = run({"--version"}, {.environment = {"OPENBLAS_CORETYPE=Nehalem"}});
  EXPECT_NE(theirs.out.find("OpenBLAS kernels: Nehalem"), std::string::npos) << theirs.out;
}

TEST(BlasKernels, AreChangedOnlyWhereTheyAreTooOld) {
  using cli::better_core_type;
  EXPECT_STREQ(better_core_type("Prescott", true, true), "SkylakeX");
  EXPECT_STREQ(better_core_type("Prescott", true, false), "Haswell");
  EXPECT_STREQ(better_core_type("Core2", true, false), "Haswell");
  EXPECT_STREQ(better_core_type("Sandybridge", true, true), "SkylakeX");
  EXPECT_EQ(better_core_type("Prescott", false, false), nullptr);
  EXPECT_EQ(better_core_type("Haswell", true, true), nullptr);
  EXPECT_EQ(better_core_type("Zen", true, true), nullptr);
  EXPECT_EQ(better_core_type("SkylakeX", true, true), nullptr);
}

}  // namespace
}  // namespace palpate::test
