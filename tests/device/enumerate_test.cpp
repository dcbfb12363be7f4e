// SPDX-License-Identifier: GPL-3.0-or-later
// The device table, the registry, and a real libusb enumeration on whatever machine this is.
#include "device/enumerate.hpp"
#include "device/registry.hpp"

#include <gtest/gtest.h>

namespace palpate::device {
namespace {

TEST(DeviceTable, IdsAreUniqueAndFound) {
  for (const DeviceKind& kind : kDevices) {
    EXPECT_EQ(find_kind(kind.vendor, kind.product), &kind) << kind.name;
    EXPECT_GT(kind.peak_force, 0.0);
    EXPECT_GE(kind.stiffness, 0.0);
  }
  EXPECT_EQ(find_kind(0xffff, 0xffff), nullptr);
}

// Someone may name a device, a kind of board, or a family.
TEST(DeviceTable, KindsAreCalledByNames) {
  for (const DeviceKind& kind : kDevices) {
    EXPECT_TRUE(is_called(kind, kind.name) && is_called(kind, kind.key) && is_called(kind, kind.driver));
    EXPECT_FALSE(is_called(kind, "") || is_called(kind, "spoon"));
    for (const DeviceKind& other : kDevices) EXPECT_EQ(is_called(kind, other.key), &kind == &other);
  }
}

TEST(Registry, WoodenDevicesHaveADriverThatLooksAtItsOptions) {
  const Driver* driver = find_driver(kDevices[0]);
  ASSERT_NE(driver, nullptr);
  std::string error;
  EXPECT_NE(driver->make(kDevices[0], {}, error), nullptr) << error;
  DriverOptions options;
  options.wooden.geometry.upper = -1;
  EXPECT_EQ(driver->make(kDevices[0], options, error), nullptr);
  EXPECT_FALSE(error.empty());
  DeviceKind stranger = kDevices[0];
  stranger.driver = "stranger";
  EXPECT_EQ(find_driver(stranger), nullptr);
}

TEST(Registry, SaysWhyNothingWasOpened) {
  const auto unknown = open_device("spoon");
  EXPECT_EQ(unknown.device, nullptr);
  EXPECT_EQ(unknown.fault, Fault::refused);
  EXPECT_NE(unknown.error.find("spoon"), std::string::npos);
}

TEST(Enumerate, EndsWithAListOrACause) {
  const Enumeration e = enumerate();
  EXPECT_NE(e.ok, !e.error.empty());
  for (const FoundDevice& d : e.found) EXPECT_NE(d.kind, nullptr);
}

}  // namespace
}  // namespace palpate::device
