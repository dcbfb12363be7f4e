// SPDX-License-Identifier: GPL-3.0-or-later
// Writing: whole or not at all, and every refusal of the system is reported.
#include "tests/support/shapes.hpp"
#include "tests/surface_io/scratch.hpp"

#include <sys/resource.h>

#include <csignal>
#include <sstream>

namespace palpate::test {
namespace {

std::size_t entries(const Scratch& scratch) {
  return std::size_t(std::distance(std::filesystem::directory_iterator(scratch.folder()), {}));
}

TEST(WriteSurface, UnwritablePlaces) {
  const Scratch scratch;
  const Surface box = box_surface({0, 0, 0}, {1, 1, 1});
  scratch.write("file", "x");
  expect_error([&] { write_surface(box, scratch / "none/box.ply"); }, ExitCode::io, {"none/box.ply"});
  expect_error([&] { write_surface(box, scratch / "file/box.ply"); }, ExitCode::io, {"file/box.ply"});
  std::filesystem::create_directory(scratch / "folder.ply");
  expect_error([&] { write_surface(box, scratch / "folder.ply"); }, ExitCode::io, {"folder.ply"});
  EXPECT_EQ(entries(scratch), 2U) << "a temporary file was left";
}

TEST(WriteSurface, BadRequests) {
  const Scratch scratch;
  Surface box = box_surface({0, 0, 0}, {1, 1, 1});
  expect_error([&] { write_surface(box, scratch / "box.glb"); }, ExitCode::bad_input, {"box.glb", ".ply"});
  box.triangles[2][0] = 8;
  expect_error([&] { write_surface(box, scratch / "box.ply"); }, ExitCode::bad_input, {"triangle 2", "8"});
  EXPECT_EQ(entries(scratch), 0U);
}

// A limit on the size of a file stops a write in the middle, like a full disk.
TEST(WriteSurface, FullDiskLeavesTheOldFile) {
  const Scratch scratch;
  const auto file = scratch / "ball.ply";
  write_surface(box_surface({0, 0, 0}, {1, 1, 1}), file);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit tight = before;
  tight.rlim_cur = 1000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
  expect_error([&] { write_surface(sphere_surface({0, 0, 0}, 1), file); }, ExitCode::io, {"ball.ply", "cannot write"});
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(read(file).triangles.size(), 12U);
  EXPECT_EQ(entries(scratch), 1U);
}

TEST(WriteSurface, SameBytesEveryTime) {
  const Scratch scratch;
  for (const std::string extension : {".obj", ".off", ".ply", ".stl"}) {
    std::array<std::string, 2> bytes;
    for (auto& content : bytes) {
      write_surface(sphere_surface({0.1, 0, 0}, 0.3), scratch / ("s" + extension));
      std::ostringstream text;
      text << std::ifstream(scratch / ("s" + extension), std::ios::binary).rdbuf();
      content = text.str();
    }
    EXPECT_EQ(bytes[0], bytes[1]) << extension;
    EXPECT_FALSE(bytes[0].empty());
  }
}

}  // namespace
}  // namespace palpate::test
