// SPDX-License-Identifier: GPL-3.0-or-later
// Devices are found, distinguished, plugged in and removed through libusb's own enumeration and hot-plug events on a
// mock bus. Run under umockdev-wrapper; skipped otherwise.
#include "device/usb/plug_watch.hpp"
#include "tests/device/front/mock_bus.hpp"
#include "tests/device/usb/driven.hpp"
#include "tests/device/usb/emulated.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

namespace palpate::usb_plug_test {
namespace {

using namespace test;
using device::Fault;
using device::Phase;

/// A device that is soon ready.
struct Socket {
  explicit Socket(const char* driver) : subject(emulated(driver)) {}

  void plug(MockBus& bus, int address) {
    bus.plug(port, address);
    port.with_model([&] { subject->settle(); });
  }

  std::unique_ptr<Emulated> subject;
  UsbPort port{subject->model()};
};

class UsbPlug : public testing::Test {
protected:
  void SetUp() override {
    if (!MockBus::possible()) GTEST_SKIP() << "runs under umockdev-wrapper only";
    bus = std::make_unique<MockBus>();
  }

  Socket& socket(const char* driver) { return sockets.emplace_back(driver); }

  static Driven open(const Socket& socket) {
    Driven driven;
    driven.opened = device::open_device(socket.subject->kind().driver, socket.subject->options(true));
    driven.device = std::move(driven.opened.device);
    return driven;
  }

  std::deque<Socket> sockets;  // outlive the bus
  std::unique_ptr<MockBus> bus;
};

TEST_F(UsbPlug, NothingIsThereThenOneOfEachIs) {
  for (const char* driver : kDrivers) socket(driver);
  device::Enumeration seen = device::enumerate();
  ASSERT_TRUE(seen.ok) << seen.error;
  EXPECT_TRUE(seen.found.empty());
  for (const Socket& each : sockets) EXPECT_EQ(open(each).opened.fault, Fault::unplugged);

  int address = 2;
  for (Socket& each : sockets) each.plug(*bus, ++address);
  seen = device::enumerate();
  ASSERT_EQ(seen.found.size(), sockets.size());
  address = 2;
  for (const Socket& each : sockets) {
    const device::DeviceKind& kind = each.subject->kind();
    const int place = ++address;
    EXPECT_TRUE(std::any_of(seen.found.begin(), seen.found.end(), [&](const device::FoundDevice& found) {
      return found.kind == &kind && found.bus == 1 && found.address == place;
    })) << kind.name;
    Driven driven = open(each);
    ASSERT_TRUE(driven.device) << driven.opened.error;
    EXPECT_STREQ(driven.device->kind().key, kind.key);
    EXPECT_TRUE(driven.reach(Phase::ready)) << kind.name;
  }
}

// A program that continues after a cable was pulled waits for the device and opens it again.
TEST_F(UsbPlug, IsWatchedAndOpenedAgain) {
  using Watch = device::PlugWatch;
  int address = 10;
  for (const Watch::By by : {Watch::By::events, Watch::By::looking}) {
    Watch watch(by);
    ASSERT_EQ(watch.error(), "");
    EXPECT_TRUE(watch.wait(0.05).empty());
    for (const char* driver : kDrivers) {
      Socket& here = socket(driver);
      for (int life = 0; life < 2; ++life) {
        here.plug(*bus, ++address);
        auto events = watch.wait(5);
        ASSERT_EQ(events.size(), 1U);
        EXPECT_TRUE(events[0].arrived);
        EXPECT_EQ(events[0].device.kind, &here.subject->kind());
        EXPECT_EQ(events[0].device.address, address);
        Driven driven = open(here);
        ASSERT_TRUE(driven.device) << driven.opened.error;
        ASSERT_TRUE(driven.reach(Phase::ready)) << driver;
        bus->unplug(address);
        EXPECT_EQ(driven.drive(5, {0, 0, 1}).fault, Fault::unplugged);
        events = watch.wait(5);
        ASSERT_EQ(events.size(), 1U);
        EXPECT_FALSE(events[0].arrived);
        EXPECT_EQ(events[0].device.address, address);
      }
    }
  }
}

TEST_F(UsbPlug, ASecondWatchIsToldOfWhatIsThereAlready) {
  socket("wooden").plug(*bus, 6);
  device::PlugWatch watch;
  const auto events = watch.wait(5);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_TRUE(events[0].arrived);
  EXPECT_EQ(events[0].device.address, 6);
}

TEST_F(UsbPlug, OpensTheOneAtAPlace) {
  Socket& one = socket("wooden");
  Socket& other = socket("wooden");
  one.plug(*bus, 7);
  other.plug(*bus, 8);
  const device::DeviceKind& kind = one.subject->kind();
  const auto protocol = [] { return std::make_unique<device::WoodenProtocol>(quick_homing()); };
  Driven driven;
  driven.opened = device::UsbDevice::open(kind, {1, 8}, protocol());
  ASSERT_TRUE(driven.opened.device) << driven.opened.error;
  driven.device = std::move(driven.opened.device);
  ASSERT_TRUE(driven.reach(Phase::ready));
  EXPECT_TRUE(one.port.log().empty());
  EXPECT_FALSE(other.port.log().empty());
  EXPECT_EQ(device::UsbDevice::open(kind, {1, 9}, protocol()).fault, Fault::unplugged);
}

}  // namespace
}  // namespace palpate::usb_plug_test
