// SPDX-License-Identifier: GPL-3.0-or-later
// Replays the fuzzer's findings, and the goldens it starts from, without clang: every build keeps the reader's promises
// on them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/fuzz/try_response.hpp"

namespace palpate::test {
namespace {

std::vector<std::filesystem::path> files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> list;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".palp") list.push_back(entry.path());
  }
  return list;
}

std::vector<std::uint8_t> bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(FuzzReplay, GoldensAreTriedInEverything) {
  const auto list = files(PALPATE_GOLDENS);
  ASSERT_GE(list.size(), 7U);
  for (const auto& file : list) {
    const std::vector<std::uint8_t> data = bytes(file);
    EXPECT_TRUE(try_response(data.data(), data.size())) << file;
  }
}

TEST(FuzzReplay, WhatTheFuzzerFoundIsRefusedOrHarmless) {
  const auto list = files(PALPATE_CORPUS);
  ASSERT_FALSE(list.empty());
  int opened = 0;
  for (const auto& file : list) {
    SCOPED_TRACE(file);
    const std::vector<std::uint8_t> data = bytes(file);
    opened += try_response(data.data(), data.size()) ? 1 : 0;
  }
  EXPECT_GT(opened, 0);
}

}  // namespace
}  // namespace palpate::test
