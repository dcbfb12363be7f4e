// SPDX-License-Identifier: GPL-3.0-or-later
// The device table, the registry, and a real libusb enumeration on whatever machine this is.
#include "device/usb/enumerate.hpp"
#include "device/registry/registry.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

namespace palpate::device {
namespace {

TEST(DeviceTable, IdsAreUniqueAndFound) {
  for (const DeviceKind& kind : kDevices) {
    EXPECT_EQ(find_kind(kind.vendor, kind.product), &kind) << kind.name;
    EXPECT_GT(kind.peak_force, 0.0);
    EXPECT_GE(kind.stiffness, 0.0);
    EXPECT_EQ(length(kind.up), 1.0);
  }
  EXPECT_EQ(find_kind(0xffff, 0xffff), nullptr);
}

// The rules that are installed open these devices to users, each once, and no other.
TEST(DeviceTable, UdevRulesNameItsIds) {
  std::ifstream file(PALPATE_UDEV_RULES);
  std::vector<std::string> rules, expected;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line.front() != '#') rules.push_back(line);
  }
  for (const DeviceKind& kind : kDevices) {
    char rule[200];
    std::snprintf(rule, sizeof rule,
                  R"(ACTION!="remove", SUBSYSTEM=="usb", ENV{DEVTYPE}=="usb_device", ATTR{idVendor}=="%04x", )"
                  R"(ATTR{idProduct}=="%04x", TAG+="uaccess")",
                  kind.vendor, kind.product);
    expected.emplace_back(rule);
  }
  EXPECT_EQ(rules, expected);
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
