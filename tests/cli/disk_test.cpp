// SPDX-License-Identifier: GPL-3.0-or-later
// Results that cannot be written: exit code 4, the cause, and no half-written file.
#include "tests/cli/palpate_program.hpp"
#include "tests/support/response_samples.hpp"

#include <unistd.h>

namespace palpate::test {
namespace {

using Arguments = std::vector<std::string>;

const Arguments kSynth{"synth", "slab", "--out", "out"};

std::vector<std::string> files_below(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  if (!std::filesystem::exists(folder)) return names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) names.push_back(entry.path().filename().string());
  }
  return names;
}

class Disk : public PalpateProgram {};

TEST_F(Disk, StandardOutputIsFull) {
  for (const Arguments& arguments :
       {Arguments{"scene", "--reference"}, Arguments{"synth", "slab", "--out", "a"},
        Arguments{"synth", "slab", "--out", "a", "--json"}, Arguments{"--help"}, Arguments{"--version"}}) {
    const RunResult result = run(arguments, {.output = "/dev/full"});
    expect_failure(result, 4, {"standard output", "No space left on device"});
  }
}

TEST_F(Disk, AFileIsTooLarge) {
  // The motion takes 280 kB, the slab's surface 30 kB.
  for (const std::size_t limit : {std::size_t{0}, std::size_t{10'000}, std::size_t{100'000}}) {
    const RunResult result = run(kSynth, {.file_limit = limit});
    EXPECT_EQ(result.signal, 0);
    EXPECT_EQ(result.exit_code, 4) << limit;
    if (limit > 4096) {  // else not even the message fits into its file
      expect_failure(result, 4, {"File too large", limit < 30'000 ? "slab.ply" : "motion.csv"});
    }
    for (const std::string& name : files_below(folder() / "out")) EXPECT_EQ(name, "slab.ply");
  }
}

TEST_F(Disk, IsFull) {
  std::filesystem::create_directory(folder() / "disk");
  const RunResult result = run({"synth", "slab", "--out", "disk/out"}, {.small_disk = folder() / "disk"});
  if (!result.mounted) GTEST_SKIP() << "this user may not mount a small file system";
  expect_failure(result, 4, {"motion.csv", "No space left on device"});
}

TEST_F(Disk, TheFolderCannotBeMade) {
  write("file", "x");
  for (const char* out : {"file/out", "file", "/proc/none/out", "/dev/null/out"}) {
    expect_failure(run({"synth", "slab", "--out", out}), 4, {out, "cannot create the folder"});
  }
  if (::geteuid() != 0) {  // root may write anywhere
    std::filesystem::create_directory(folder() / "closed");
    std::filesystem::permissions(folder() / "closed", std::filesystem::perms::owner_read);
    expect_failure(run({"synth", "slab", "--out", "closed/out"}), 4, {"Permission denied"});
    std::filesystem::permissions(folder() / "closed", std::filesystem::perms::owner_all);
  }
}

TEST_F(Disk, AFolderIsInTheWay) {
  std::filesystem::create_directories(folder() / "out" / "motion.csv");
  expect_failure(run(kSynth), 4, {"motion.csv", "cannot write the file"});
}

TEST_F(Disk, TracesCannotBeWritten) {
  write_response_file(folder() / "ball.palp", encode(ball_content()));
  write("still.csv", "t,x,y,z,qw,qx,qy,qz\n0,0,0,0.05,1,0,0,0\n0.01,0,0,0.05,1,0,0,0\n");
  write("file", "x");
  for (const char* option : {"--out", "--plot"}) {
    expect_failure(run({"play", "ball.palp", "still.csv", option, "file/trace"}), 4, {"file/trace"});
    expect_failure(run({"play", "ball.palp", "still.csv", option, "/dev/null/trace"}), 4, {"/dev/null/trace"});
  }
  for (const Arguments& arguments : {Arguments{"inspect", "ball.palp"}, Arguments{"play", "ball.palp", "still.csv"}}) {
    expect_failure(run(arguments, {.output = "/dev/full"}), 4, {"standard output", "No space left on device"});
  }
}

TEST_F(Disk, WhereTheResponseFileCannotBeIsFoundBeforeTheBake) {
  ASSERT_EQ(run({"synth", "slab", "--out", "."}).exit_code, 0);
  expect_failure(run({"build", "scene.toml", "-o", "none/x.palp"}), 4, {"none/x.palp: cannot be written", "No such"});
  EXPECT_FALSE(std::filesystem::exists(folder() / "scene.work"));
}

TEST_F(Disk, AFitWithoutSamplesLeavesNoFolder) {
  ASSERT_EQ(run({"synth", "slab", "--out", ".", "--spacing", "0.05"}).exit_code, 0);
  expect_failure(run({"fit", "scene.toml", "--work", "none"}), 4, {"none/samples.journal: there is no journal"});
  EXPECT_FALSE(std::filesystem::exists(folder() / "none"));
}

TEST_F(Disk, WhereAPlotCannotBeIsFoundBeforeTheWork) {
  write_response_file(folder() / "ball.palp", encode(ball_content()));
  write("slab.toml", "[body]\nsurface = \"none.ply\"\n");
  std::filesystem::create_directory(folder() / "plots");
  std::vector<Arguments> commands{{"verify", "slab.toml"}, {"verify", "ball.palp", "--samples", "none.json"}};
  if (listed_commands().count("bench") > 0) commands.push_back({"bench", "ball.palp", "--seconds", "10"});
  if (listed_commands().count("drive") > 0) commands.push_back({"drive", "ball.palp", "--device", "sim"});
  for (Arguments arguments : commands) {
    arguments.insert(arguments.end(), {"--plot", "plots"});
    expect_failure(run(arguments, {.time_limit = 30}), 4, {"plots: cannot be written: Is a directory"});
    arguments.back() = "none/plot.svg";
    expect_failure(run(arguments, {.time_limit = 30}), 4, {"none/plot.svg: cannot be written: No such file"});
  }
  EXPECT_FALSE(std::filesystem::exists(folder() / "ball.palprun"));
}

TEST_F(Disk, AManifestThatCannotBeLookedAtIsAnInputOutputFailure) {
  ASSERT_EQ(run({"synth", "slab", "--out", "."}).exit_code, 0);
  std::filesystem::create_directory(folder() / "work");
  std::filesystem::create_symlink("manifest.json", folder() / "work" / "manifest.json");  // to itself
  expect_failure(run({"plan", "scene.toml", "--work", "work"}), 4, {"work/manifest.json"});
}

TEST_F(Disk, ADamagedAccountOfABakeIsBadInput) {
  ASSERT_EQ(run({"synth", "slab", "--out", "."}).exit_code, 0);
  std::filesystem::create_directory(folder() / "work");
  write("work/bake.json", "{\"manifest\": 3}");
  expect_failure(run({"bake", "scene.toml", "--work", "work"}), 2, {"work/bake.json"});
}

TEST_F(Disk, TheWorkFolderCannotBeMade) {
  ASSERT_EQ(run({"synth", "slab", "--out", "."}).exit_code, 0);
  write("file", "x");
  for (const std::string& command : listed_commands()) {
    if (command != "plan" && command != "bake" && command != "build") continue;
    SCOPED_TRACE(command);
    expect_failure(run({command, "scene.toml", "--work", "file/work"}), 4, {"file/work"});
    const RunResult limited = run({command, "scene.toml", "--work", "work"}, {.file_limit = 1000});
    expect_failure(limited, 4, {"work/manifest.json", "File too large"});
  }
}

}  // namespace
}  // namespace palpate::test
