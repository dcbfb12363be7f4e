// SPDX-License-Identifier: GPL-3.0-or-later
// The fuzzer's target without a fuzzer: some thousand scripts of chance, the same every time.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/device/seeded.hpp"
#include "tests/fuzz/try_device.hpp"

namespace palpate::test {
namespace {

TEST(AnyBytes, LanguagesKeepTheirPromises) {
  Seeded random(11);
  for (int i = 0; i < 4000; ++i) {
    std::vector<std::uint8_t> bytes(1 + random.below(600));
    for (std::uint8_t& byte : bytes) byte = random.byte();
    bytes[0] = static_cast<std::uint8_t>(i % kTrials);
    try_device(bytes.data(), bytes.size());
  }
}

TEST(AnyBytes, WhatTheFuzzerKeptIsHarmless) {
  int tried = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_DEVICE_CORPUS)) {
    SCOPED_TRACE(entry.path());
    std::ifstream file(entry.path(), std::ios::binary);
    const std::vector<char> read{std::istreambuf_iterator<char>(file), {}};
    const std::vector<std::uint8_t> bytes(read.begin(), read.end());
    try_device(bytes.data(), bytes.size());
    ++tried;
  }
  EXPECT_GT(tried, 50);
}

// Chance gets far enough for that to mean something: scripts in which a device gets ready, and is heard for a while.
TEST(AnyBytes, GetsDevicesReady) {
  Seeded random(12);
  int falcons = 0, links = 0, arms = 0;
  device::WoodenOptions still;
  still.hold = 0.01;
  const device::DeviceKind kind{"any", 0, 0, 5, 0, 0, 0};
  for (int i = 0; i < 1000; ++i) {
    std::vector<std::uint8_t> bytes(600);
    for (std::uint8_t& byte : bytes) byte = random.byte();
    Dice falcon_dice(bytes.data(), bytes.size()), link_dice(bytes.data(), bytes.size()),
        arm_dice(bytes.data(), bytes.size());
    device::FalconProtocol falcon;
    try_script(falcon, kind, falcon_script(falcon_dice));
    falcons += length(falcon.sample().pose.translation) > 0;
    device::OpenLinkProtocol link;
    try_script(link, kind, open_link_script(link_dice));
    links += length(link.sample().pose.translation) > 0;
    device::WoodenProtocol arm(still);
    try_script(arm, kind, wooden_script(arm_dice));
    arms += length(arm.sample().pose.translation) > 0;
  }
  EXPECT_GT(falcons, 100);
  EXPECT_GT(links, 100);
  EXPECT_GT(arms, 100);
}

}  // namespace
}  // namespace palpate::test
