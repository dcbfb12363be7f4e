// SPDX-License-Identifier: GPL-3.0-or-later
// Files read by the C library and mapped files: the same bytes, aligned, and the system's words for a failure.
#include "palpate/format/loaded_file.hpp"

#include <gtest/gtest.h>
#if !defined(_WIN32)
#include <sys/stat.h>
#endif

#include <cstdint>
#include <cstring>
#include <string>

#include "palpate/format/mapped_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace palpate::loaded_file_test {
namespace {

using runtime::LoadedFile;
using runtime::MappedFile;

void write(const std::filesystem::path& path, std::size_t size) {
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  ASSERT_NE(file, nullptr);
  for (std::size_t i = 0; i < size; ++i) std::fputc(static_cast<int>(i * 7 % 251), file);
  std::fclose(file);
}

TEST(LoadedFile, BytesAreThoseOfTheMappedFile) {
  const test::TemporaryFolder folder;
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{65536}, std::size_t{300001}}) {
    const std::filesystem::path path = folder.path() / ("bytes" + std::to_string(size));
    write(path, size);
    const LoadedFile loaded(path.c_str());
    const MappedFile mapped(path.c_str());
    ASSERT_TRUE(loaded.ok()) << loaded.error();
    ASSERT_TRUE(mapped.ok()) << mapped.error();
    ASSERT_EQ(loaded.size(), size);
    ASSERT_EQ(mapped.size(), size);
    if (size == 0) continue;
    EXPECT_EQ(std::memcmp(loaded.data(), mapped.data(), size), 0);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(loaded.data()) % 16, 0U);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(mapped.data()) % 16, 0U);
  }
}

TEST(LoadedFile, FailureHasTheSystemsWords) {
  const test::TemporaryFolder folder;
  for (const std::filesystem::path& path : {folder.path() / "missing", folder.path()}) {
    const LoadedFile loaded(path.c_str());
    EXPECT_FALSE(loaded.ok());
    EXPECT_STREQ(loaded.error(), path == folder.path() ? "Is a directory" : "No such file or directory");
    EXPECT_EQ(loaded.size(), 0U);
    EXPECT_EQ(loaded.data(), nullptr);
  }
}

#if !defined(_WIN32)
TEST(MappedFile, FifoIsRefusedAtOnce) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "fifo";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const MappedFile mapped(path.c_str());
  EXPECT_FALSE(mapped.ok());
  EXPECT_STREQ(mapped.error(), "Invalid argument");
}
#endif

}  // namespace
}  // namespace palpate::loaded_file_test
