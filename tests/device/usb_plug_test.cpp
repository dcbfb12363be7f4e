// SPDX-License-Identifier: GPL-3.0-or-later
// Devices that are found, opened by name, pulled out and plugged in again, through libusb's own enumeration and
// hot-plug events on a mock bus. Run under umockdev-wrapper; skipped otherwise.
#include "device/plug_watch.hpp"
#include "device/registry.hpp"
#include "tests/device/front/mock_bus.hpp"
#include "tests/device/models/wooden_model.hpp"
#include "tests/device/rig.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

using namespace test;
using device::Fault;
using device::Phase;
using device::Sample;

device::DriverOptions options() {
  device::DriverOptions result;
  result.wooden = quick_homing();
  return result;
}

class UsbPlug : public testing::Test {
protected:
  void SetUp() override {
    if (!MockBus::possible()) GTEST_SKIP() << "runs under umockdev-wrapper only";
    bus = std::make_unique<MockBus>();
  }

  // The force loop until the device is in `phase` or stopped.
  static Sample drive(device::Device& device, Phase phase, double seconds = 5) {
    Sample sample = device.read();
    for (const double end = device::now() + seconds; device::now() < end; pause(0.001)) {
      device.write({device::now(), {0, 0, 1}, {}});
      sample = device.read();
      if (sample.phase == phase || sample.phase == Phase::stopped) break;
    }
    return sample;
  }

  WoodenModel model, other_model;
  UsbPort port{model}, other{other_model};
  std::unique_ptr<MockBus> bus;
};

TEST_F(UsbPlug, NothingIsThereThenSomethingIs) {
  device::Enumeration seen = device::enumerate();
  ASSERT_TRUE(seen.ok) << seen.error;
  EXPECT_TRUE(seen.found.empty());
  const auto absent = device::open_device("wooden", options());
  EXPECT_FALSE(absent.device);
  EXPECT_EQ(absent.fault, Fault::unplugged);
  bus->plug(port, 3);
  seen = device::enumerate();
  ASSERT_EQ(seen.found.size(), 1u);
  EXPECT_EQ(seen.found[0].kind, &device::kDevices[0]);
  EXPECT_EQ(seen.found[0].bus, 1);
  EXPECT_EQ(seen.found[0].address, 3);
}

TEST_F(UsbPlug, OpensByNameHomesPushesAndIsPulledOut) {
  bus->plug(port, 2);
  const auto opened = device::open_device("wooden", options());
  ASSERT_TRUE(opened.device) << opened.error;
  ASSERT_EQ(drive(*opened.device, Phase::ready).phase, Phase::ready);
  drive(*opened.device, Phase::stopped, 0.1);
  const std::vector<Written> log = port.log();
  EXPECT_TRUE(std::any_of(log.begin(), log.end(), [](const Written& each) { return !is_zero(each.bytes); }));
  bus->unplug(2);
  EXPECT_EQ(drive(*opened.device, Phase::stopped).fault, Fault::unplugged);
  opened.device->close();
  EXPECT_EQ(opened.device->read().phase, Phase::closed);
}

TEST_F(UsbPlug, ClosesWithAZero) {
  // A zero has 10 ms to leave, in which this bus does not always get there.
  bool left = false;
  for (int address = 20; address < 30 && !left; ++address) {
    bus->plug(port, address);
    const auto opened = device::open_device("wooden-mbed", options());
    ASSERT_TRUE(opened.device) << opened.error;
    ASSERT_EQ(drive(*opened.device, Phase::ready).phase, Phase::ready);
    opened.device->close();
    left = opened.device->counts().zero_left;
    if (left) {
      EXPECT_TRUE(is_zero(port.log().back().bytes));
    } else {
      bus->unplug(address);
    }
  }
  EXPECT_TRUE(left);
}

// What a program does that goes on after a cable was pulled: it waits for the device and opens it again.
TEST_F(UsbPlug, IsWatchedAndOpenedAgain) {
  using Watch = device::PlugWatch;
  int address = 10;
  for (const Watch::By by : {Watch::By::events, Watch::By::looking}) {
    Watch watch(by);
    ASSERT_EQ(watch.error(), "");
    EXPECT_TRUE(watch.wait(0.05).empty());
    for (int life = 0; life < 2; ++life) {
      bus->plug(port, ++address);
      auto events = watch.wait(5);
      ASSERT_EQ(events.size(), 1u);
      EXPECT_TRUE(events[0].arrived);
      EXPECT_EQ(events[0].device.kind, &device::kDevices[0]);
      EXPECT_EQ(events[0].device.address, address);
      const auto opened = device::open_device("wooden", options());
      ASSERT_TRUE(opened.device) << opened.error;
      ASSERT_EQ(drive(*opened.device, Phase::ready).phase, Phase::ready);
      bus->unplug(address);
      EXPECT_EQ(drive(*opened.device, Phase::stopped).fault, Fault::unplugged);
      events = watch.wait(5);
      ASSERT_EQ(events.size(), 1u);
      EXPECT_FALSE(events[0].arrived);
      EXPECT_EQ(events[0].device.address, address);
    }
  }
}

TEST_F(UsbPlug, ASecondWatchIsToldOfWhatIsThereAlready) {
  bus->plug(port, 6);
  device::PlugWatch watch;
  const auto events = watch.wait(5);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_TRUE(events[0].arrived);
  EXPECT_EQ(events[0].device.address, 6);
}

TEST_F(UsbPlug, OpensTheOneAtAPlace) {
  bus->plug(port, 7);
  bus->plug(other, 8);
  const auto opened =
      device::UsbDevice::open(device::kDevices[0], {1, 8}, std::make_unique<device::WoodenProtocol>(quick_homing()));
  ASSERT_TRUE(opened.device) << opened.error;
  ASSERT_EQ(drive(*opened.device, Phase::ready).phase, Phase::ready);
  EXPECT_TRUE(port.log().empty());
  EXPECT_FALSE(other.log().empty());
  EXPECT_EQ(device::UsbDevice::open(device::kDevices[0], {1, 9}, std::make_unique<device::WoodenProtocol>()).fault,
            Fault::unplugged);
}

}  // namespace
}  // namespace palpate
