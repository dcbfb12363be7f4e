// SPDX-License-Identifier: GPL-3.0-or-later
// The command that a device receives.
#include "device/clamp_command.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace palpate::device {
namespace {

const DeviceKind kKind = {"test", 0, 0, 5.0, 0.0, 0.0, 0.0};

TEST(ClampCommand, LetsThroughWhatIsFreshAndSmall) {
  const Command out = clamp_command({1.0, {1, -2, 3}, {0.1, 0, 0}}, kKind, 1.009);
  EXPECT_EQ(out.force.x, 1);
  EXPECT_EQ(out.force.y, -2);
  EXPECT_EQ(out.force.z, 3);
  EXPECT_EQ(out.torque.x, 0.1);
}

TEST(ClampCommand, ShortensAlongTheSameLine) {
  const Vec3 force{30, -40, 120};
  const Command out = clamp_command({1.0, force, {}}, kKind, 1.0);
  EXPECT_NEAR(length(out.force), 5, 1e-12);
  EXPECT_LT(length(cross(out.force, force)), 1e-12);
  EXPECT_GT(dot(out.force, force), 0);
}

TEST(ClampCommand, WhatIsStaleOrOfTheFutureOrNoNumberIsZero) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  const auto zero = [](const Command& command, double time) {
    const Command out = clamp_command(command, kKind, time);
    return length(out.force) == 0 && length(out.torque) == 0;
  };
  EXPECT_FALSE(zero({1.0, {1, 1, 1}, {}}, 1.0 + kStale - 1e-6));
  EXPECT_TRUE(zero({1.0, {1, 1, 1}, {1, 1, 1}}, 1.0 + kStale + 1e-6));
  EXPECT_TRUE(zero({1.0, {1, 1, 1}, {}}, 1.0 - kStale - 1e-6));
  EXPECT_TRUE(zero({nan, {1, 1, 1}, {}}, 1.0));
  EXPECT_TRUE(zero({1.0, {nan, 1, 1}, {}}, 1.0));
  EXPECT_TRUE(zero({1.0, {1, infinite, 1}, {}}, 1.0));
  EXPECT_TRUE(zero({1.0, {1, 1, 1}, {0, 0, nan}}, 1.0));
  EXPECT_TRUE(zero({1.0, {1e300, 1, 1}, {}}, 1.0));
}

}  // namespace
}  // namespace palpate::device
