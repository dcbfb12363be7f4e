// SPDX-License-Identifier: GPL-3.0-or-later
// The device table, and a real libusb enumeration on whatever machine this is.
#include "device/enumerate.hpp"

#include <gtest/gtest.h>

namespace palpate::device {
namespace {

TEST(DeviceTable, IdsAreUniqueAndFound) {
  for (const DeviceKind& kind : kDevices) {
    EXPECT_EQ(find_kind(kind.vendor, kind.product), &kind) << kind.name;
    EXPECT_GT(kind.peak_force, 0.0);
    EXPECT_GT(kind.stiffness, 0.0);
  }
  EXPECT_EQ(find_kind(0xffff, 0xffff), nullptr);
}

TEST(Enumerate, EndsWithAListOrACause) {
  const Enumeration e = enumerate();
  EXPECT_NE(e.ok, !e.error.empty());
  for (const FoundDevice& d : e.found) EXPECT_NE(d.kind, nullptr);
}

}  // namespace
}  // namespace palpate::device
