// SPDX-License-Identifier: GPL-3.0-or-later
// Whole files: what is written reads back, a failed write leaves the old file, causes are named.
#include "formats/io/file.hpp"

#include "formats/io/error.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <functional>
#include <iterator>

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

std::size_t entries(const test::TemporaryFolder& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder.path()), {}));
}

TEST(File, RoundTripAndReplace) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "a.bin";
  const std::string first(200'000, 'x'), second("a\0b\n", 4);
  write_file(path, first);
  EXPECT_EQ(read_file(path, "test", 1 << 20), first);
  write_file(path, second);
  EXPECT_EQ(read_file(path, "test", 4), second);
  EXPECT_EQ(entries(folder), 1U) << "a temporary file was left";
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

// A node must stay what it is: as root, renaming over /dev/null would replace it for the whole system.
TEST(File, APipeIsWrittenToAndStays) {
  const test::TemporaryFolder folder;
  const auto pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::string got(3, ' ');
  // Opened for both directions: neither side waits for the other, and what is written fits the pipe.
  const int reader = ::open(pipe.c_str(), O_RDWR | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  write_file(pipe, "abc");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_EQ(::read(reader, got.data(), got.size()), 3);
  EXPECT_EQ(got, "abc");
  const auto link = folder.path() / "link";
  std::filesystem::create_symlink("pipe", link);
  write_file(link, "def");
  EXPECT_TRUE(std::filesystem::is_symlink(link) && std::filesystem::is_fifo(pipe));
  EXPECT_EQ(::read(reader, got.data(), got.size()), 3);
  EXPECT_EQ(got, "def");
  ::close(reader);
  EXPECT_EQ(entries(folder), 2U);
}

TEST(File, ALinkStaysAndTheFileBehindItIsWritten) {
  const test::TemporaryFolder folder;
  const auto below = folder.path() / "below";
  make_folder(below);
  const auto file = below / "file", link = folder.path() / "link", chain = below / "chain";
  std::filesystem::create_symlink("below/file", link);
  std::filesystem::create_symlink(link, chain);
  for (const std::string& text : {std::string("new"), std::string("again")}) {  // the file is missing at first
    write_file(chain, text);
    EXPECT_TRUE(std::filesystem::is_symlink(link) && std::filesystem::is_symlink(chain));
    EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(file)));
    EXPECT_EQ(read_file(file, "test", 10), text);
  }
  EXPECT_EQ(entries(folder), 2U) << "a temporary file was left";
  std::filesystem::create_symlink("round", folder.path() / "round");
  expect_error(ExitCode::io, "cannot", [&] { write_file(folder.path() / "round", "x"); });
}

TEST(File, APipeIsRefusedAtOnce) {
  const test::TemporaryFolder folder;
  const auto pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_error(ExitCode::io, "not a regular file", [&] { read_file(pipe, "test", 10); });
}

}  // namespace
}  // namespace palpate
