// SPDX-License-Identifier: GPL-3.0-or-later
// Every command that takes a scene refuses bad ones alike. The full table of keys is in tests/scene.
#include "tests/cli/palpate_program.hpp"

#include <ostream>

namespace palpate::test {
namespace {

struct Case {
  std::string name;
  std::string scene;  ///< content of scene.toml
  int code;
  std::vector<std::string> cause;
};

/// For the test's name and output; otherwise the bytes of the case are printed.
[[maybe_unused]] void PrintTo(const Case& test_case, std::ostream* out) { *out << test_case.name; }

const std::string kBody = "[body]\nsurface = \"box.off\"\n";

const std::vector<Case> kCases{
    {"empty", "", 2, {"scene.toml: body.surface: missing"}},
    {"truncated", kBody + "[sampling]\ndepth = ", 2, {"scene.toml:4: not TOML"}},
    {"binary garbage", std::string("\x7f\x45\x4c\x46\x02\x00\xff\xfe", 8), 2, {"scene.toml:1: not TOML"}},
    {"unknown key", kBody + "[sampling]\ndeph = 0.005\n", 2, {"scene.toml:4: sampling.deph: unknown key", "'depth'"}},
    {"wrong type", kBody + "[material]\nyoung = \"soft\"\n", 2, {"scene.toml:4: material.young: got \"soft\"", "Pa"}},
    {"poisson", kBody + "[material]\npoisson = 0.5\n", 2, {"scene.toml:4: material.poisson: got 0.5", "x <= 0.4999"}},
    {"modulus", kBody + "[material]\nyoung = -5e3\n", 2, {"scene.toml:4: material.young: got -5000", "0 < x"}},
    {"depth", kBody + "[sampling]\ndepth = 0\n", 2, {"scene.toml:4: sampling.depth: got 0", "0 < x"}},
    {"tool radius", kBody + "[tool]\nradius = 0\n", 2, {"scene.toml:4: tool.radius: got 0", "0 < x"}},
    {"nan", kBody + "[contact]\nfriction = nan\n", 2, {"scene.toml:4: contact.friction: got nan", "0 <= x <= 2"}},
    // The check of the scene and the reader of surfaces begin the phrase differently.
    {"surface missing", kBody, 4, {"box.off", "o such file"}},
};

/// Commands that take a scene as their first argument.
std::vector<std::string> scene_commands() {
  std::vector<std::string> names;
  for (const std::string& name : listed_commands()) {
    for (const char* takes : {"scene", "mesh", "plan", "bake", "fit", "build", "verify"}) {
      if (name == takes) names.push_back(name);
    }
  }
  return names;
}

class BadScene : public PalpateProgram, public testing::WithParamInterface<Case> {};

TEST_P(BadScene, IsRefusedByEveryCommand) {
  write("scene.toml", GetParam().scene);
  for (const std::string& command : scene_commands()) {
    SCOPED_TRACE(command);
    expect_failure(run({command, "scene.toml"}), GetParam().code, GetParam().cause);
    EXPECT_FALSE(std::filesystem::exists(folder() / "scene.palp"));
  }
}

INSTANTIATE_TEST_SUITE_P(Table, BadScene, testing::ValuesIn(kCases),
                         [](const auto& test_case) { return test_name(test_case.param.name); });

class SceneFile : public PalpateProgram {};

TEST_F(SceneFile, SurfacesAreThereAndAreFiles) {
  write("scene.toml", kBody);
  expect_failure(run({"scene", "scene.toml"}), 4, {"box.off", "there is no such file"});
  std::filesystem::create_directory(folder() / "box.off");
  expect_failure(run({"scene", "scene.toml"}), 4, {"box.off", "is no regular file"});
}

class NoScene : public PalpateProgram {};

TEST_F(NoScene, IsAnInputOutputFailure) {
  std::filesystem::create_directory(folder() / "folder.toml");
  for (const std::string& command : scene_commands()) {
    SCOPED_TRACE(command);
    expect_failure(run({command, "none.toml"}), 4, {"none.toml", "No such file"});
    expect_failure(run({command, "folder.toml"}), 4, {"folder.toml", "not a regular file"});
    expect_failure(run({command, "/dev/zero"}), 4, {"/dev/zero", "not a regular file"});
  }
}

}  // namespace
}  // namespace palpate::test
