// SPDX-License-Identifier: GPL-3.0-or-later
// Whole files: what is written reads back, a failed write leaves the old file, causes are named.
#include "formats/file.hpp"

#include "formats/error.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <functional>

namespace palpate {
namespace {

void expect_error(ExitCode code, const std::string& cause, const std::function<void()>& action) {
  try {
    action();
    ADD_FAILURE() << "no error; expected: " << cause;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_NE(std::string(error.what()).find(cause), std::string::npos) << error.what();
  }
}

TEST(File, RoundTripAndReplace) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "a.bin";
  const std::string first(200'000, 'x'), second("a\0b\n", 4);
  write_file(path, first);
  EXPECT_EQ(read_file(path, "test", 1 << 20), first);
  write_file(path, second);
  EXPECT_EQ(read_file(path, "test", 4), second);
  int entries = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++entries;
  EXPECT_EQ(entries, 1) << "a temporary file was left";
}

TEST(File, Refusals) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("plain", "12345");
  expect_error(ExitCode::io, "No such file", [&] { read_file(folder.path() / "none", "test", 10); });
  expect_error(ExitCode::io, "not a regular file", [&] { read_file(folder.path(), "test", 10); });
  expect_error(ExitCode::io, "not a regular file", [&] { read_file("/dev/zero", "test", 10); });
  expect_error(ExitCode::bad_input, "at most 4 bytes", [&] { read_file(file, "test", 4); });
  expect_error(ExitCode::io, "Not a directory", [&] { write_file(file / "below", "x"); });
  expect_error(ExitCode::io, "No such file", [&] { write_file(folder.path() / "none" / "below", "x"); });
  expect_error(ExitCode::io, "Not a directory", [&] { make_folder(file / "below"); });
  expect_error(ExitCode::io, "cannot create the folder", [&] { make_folder(file); });
  make_folder(folder.path() / "a" / "b");
  EXPECT_TRUE(std::filesystem::is_directory(folder.path() / "a" / "b"));
  make_folder(folder.path() / "a" / "b");
  // A folder in the way of the rename: the temporary file goes.
  expect_error(ExitCode::io, "cannot write the file", [&] { write_file(folder.path() / "a", "x"); });
}

TEST(File, APipeIsRefusedAtOnce) {
  const test::TemporaryFolder folder;
  const auto pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_error(ExitCode::io, "not a regular file", [&] { read_file(pipe, "test", 10); });
}

}  // namespace
}  // namespace palpate
