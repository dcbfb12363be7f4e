// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that are wrong as files: without a body, cut short, no text, not there.
#include "formats/io/error.hpp"
#include "formats/scene/scene.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <string>

namespace palpate {
namespace {

/// Whole files, for what does not follow a good beginning.
std::string message_of(const std::string& text, ExitCode code = ExitCode::bad_input) {
  const test::TemporaryFolder folder;
  try {
    read_scene(folder.write("scene.toml", text));
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    return std::string(error.what()).substr(folder.path().string().size() + 1);
  }
  ADD_FAILURE() << "was read: " << text;
  return "";
}

TEST(BadSceneFile, WithoutABody) {
  EXPECT_EQ(message_of("").rfind("scene.toml: body.surface: missing", 0), 0U) << message_of("");
  EXPECT_EQ(message_of("# nothing\n\n[body]\n").rfind("scene.toml:3: body.surface: missing", 0), 0U);
  EXPECT_EQ(message_of("body = 3\n").rfind("scene.toml:1: body: got 3; allowed a table", 0), 0U);
  EXPECT_NE(message_of("[body]\nsurface = []\n").find("scene.toml:2: body.surface: got an empty array"),
            std::string::npos);
  EXPECT_NE(message_of("[body]\nsurface = \"\"\n").find("body.surface: got \"\""), std::string::npos);
  EXPECT_NE(message_of("[body]\nsurface = [\"a\", 3]\n").find("body.surface: got 3"), std::string::npos);
  EXPECT_NE(message_of("[body]\nmeshes = [\"a\"]\n").find("body.meshes: there is no 'surface'"), std::string::npos);
  EXPECT_NE(message_of("[body]\nmeshes = [\"m\"]\nsurface = [\"a\", \"b\"]\n")
                .find("scene.toml:2: body.meshes: name the meshes of each"),
            std::string::npos);
  EXPECT_NE(message_of("tool = []\nbody = {surface = \"a\"}\n").find("scene.toml:1: tool: got an empty array"),
            std::string::npos);
  EXPECT_NE(message_of("tool = [1]\nbody = {surface = \"a\"}\n").find("scene.toml:1: tool: got 1"), std::string::npos);
}

TEST(BadSceneFile, KeyOutsideItsSection) {
  EXPECT_NE(message_of("depth = 0.1\n[body]\nsurface = \"a\"\n").find("belongs into the section [sampling]"),
            std::string::npos);
  EXPECT_NE(message_of("surface = \"a\"\n").find("belongs into the section [body]"), std::string::npos);
  EXPECT_NE(message_of("name = \"a/b\"\n[body]\nsurface = \"a\"\n").find("without '/'"), std::string::npos);
}

TEST(BadSceneFile, NotTextAtAll) {
  EXPECT_NE(message_of(std::string("glTF\2\0\0\0\xff\xfe\x00\x01", 12)).find("scene.toml:1: not TOML"),
            std::string::npos);
  EXPECT_NE(message_of(std::string(1000, '\0')).find("not TOML"), std::string::npos);
  EXPECT_NE(message_of(std::string(100'000, '[')).find("not TOML"), std::string::npos);
  EXPECT_NE(message_of(std::string((1 << 20) + 1, '#')).find("too large"), std::string::npos);
}

TEST(BadSceneFile, EveryTruncationIsReadOrRefused) {
  const std::string whole =
      "[body]\nsurface = \"a.ply\"\n[[support]]\nbox = {min = [0, 0, 0], max = [1, 1, 1]}\n[contact]\nfriction = "
      "0.25\n";
  const test::TemporaryFolder folder;
  int good = 0;
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    const auto file = folder.write("scene.toml", whole.substr(0, length));
    try {
      read_scene(file);
      ++good;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input);
    }
  }
  EXPECT_GT(good, 3);  // whole, and where it is cut between sections
  EXPECT_LT(good, 60);
}

TEST(BadSceneFile, Missing) {
  const test::TemporaryFolder folder;
  for (const auto& path : {folder.path() / "none.toml", folder.path()}) {
    try {
      read_scene(path);
      FAIL() << path << " was read";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::io);
      EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace palpate
