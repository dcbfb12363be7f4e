// SPDX-License-Identifier: GPL-3.0-or-later
// The driver of WoodenHaptics in detail, through libusb: what its commands say, what it follows, what it passes over.
#include "tests/device/usb/rig.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

using namespace test;
using device::Fault;
using device::Phase;
using device::Sample;
using device::Vec3;

constexpr Vec3 kPush{1, 2, 1};

// A slow circle of the tip's joints, once the arm is homed.
device::Joints circling(double time) {
  const double angle = 4 * std::max(time - 0.5, 0.0);
  return {0.3 * std::sin(angle), 0.2 * (1 - std::cos(angle)), 1.5707963267948966 + 0.2 * std::sin(angle)};
}

TEST(UsbWooden, HomesFollowsTheArmAndPushesTheWayItIsTold) {
  Rig rig;
  ASSERT_TRUE(rig.device) << rig.opened.error;
  ASSERT_TRUE(rig.reach(Phase::ready));
  const Vec3 force{1.0, -0.5, 0.25};
  const Sample sample = rig.drive(0.05, force);
  EXPECT_EQ(sample.phase, Phase::ready);
  EXPECT_EQ(sample.fault, Fault::none);
  const Vec3 home = device::position(rig.model.geometry, {0, 0, 1.5707963267948966});
  EXPECT_LT(length(sample.pose.translation - home), 1e-9);
  const device::Joints amps = device::currents(rig.model.geometry, rig.model.angles(0), force);
  const auto got = rig.last_push();
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(got[k], 1000 * amps[k], 0.51);
  rig.device->close();
  EXPECT_EQ(rig.device->read().phase, Phase::closed);
  EXPECT_TRUE(is_zero(rig.port.log().back().bytes));
  EXPECT_TRUE(rig.device->counts().zero_left);
  rig.device->close();
}

TEST(UsbWooden, EncodersThatWrapAreFollowed) {
  Rig rig;
  rig.port.with_model([&] { rig.model.motion = circling; });
  ASSERT_TRUE(rig.reach(Phase::ready));
  int samples = 0;
  double worst = 0, fastest = 0;
  std::uint32_t number = 0;
  Vec3 before{};
  for (const double end = device::now() + 2.5; device::now() < end; pause(0.001)) {
    const Sample sample = rig.device->read();
    ASSERT_EQ(sample.phase, Phase::ready) << device::name(sample.fault);
    if (sample.number == number) continue;
    // The arm moves on while a report is on its way: its pose is looked for in the last few milliseconds.
    double nearest = 1;
    for (double age = 0; age < 0.01; age += 1e-4) {
      const auto at = rig.port.with_model([&] { return rig.model.angles(sample.time - age); });
      nearest = std::fmin(nearest, length(sample.pose.translation - position(rig.model.geometry, at)));
    }
    worst = std::fmax(worst, nearest);
    if (number != 0) fastest = std::fmax(fastest, length(sample.pose.translation - before));
    before = sample.pose.translation;
    number = sample.number;
    ++samples;
  }
  EXPECT_GT(samples, 100);
  EXPECT_GT(fastest, 1e-4);
  EXPECT_LT(worst, 5e-4);  // three encoders of 0.1 mm at the tip
}

TEST(UsbWooden, NoForceBeforeItIsHomed) {
  device::WoodenOptions wooden = quick_homing();
  wooden.hold = 0.2;
  const double begun = device::now();  // no report is older, and the hold counts from the first one
  Rig rig({}, wooden);
  ASSERT_TRUE(rig.reach(Phase::homing));
  while (rig.device->read().phase == Phase::homing) {
    rig.device->write({device::now(), {5, 5, 5}, {}});
    pause(0.001);
  }
  EXPECT_EQ(rig.device->read().phase, Phase::ready);
  // All that was written before the first force is zero, and that was for the whole of the hold.
  const std::vector<Written> log = rig.port.log();
  const auto first = std::find_if(log.begin(), log.end(), [](const Written& each) { return !is_zero(each.bytes); });
  const double until = first == log.end() ? log.back().time : first->time;
  EXPECT_GT(until - begun, 0.2);
  EXPECT_GT(first - log.begin(), 50);
}

TEST(UsbWooden, ForcesAreLimitedAndNothingElseThanNumbersGoesOut) {
  Rig rig;
  ASSERT_TRUE(rig.reach(Phase::ready));
  rig.drive(0.05, {30, 0, -30});  // far beyond 5 N
  const device::Joints home{0, 0, 1.5707963267948966};
  const double part = 5 / std::sqrt(2.0);
  const device::Joints amps = device::currents(rig.model.geometry, home, {part, 0, -part});
  const auto got = rig.last_push();
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(got[k], 1000 * amps[k], 0.51);
  const double begun = device::now();
  rig.drive(0.05, {std::nan(""), 1, 1});
  rig.drive(0.05, {std::numeric_limits<double>::infinity(), 0, 0});
  for (const Written& each : rig.port.log()) {
    // The last finite command may have been on its way.
    if (each.time > begun + 0.02) {
      EXPECT_TRUE(is_zero(each.bytes));
    }
  }
}

TEST(UsbOpen, TakesTheInterfaceFromTheKernelAndGivesItBack) {
  Rig rig;
  ASSERT_TRUE(rig.device) << rig.opened.error;
  EXPECT_FALSE(rig.usbfs->kernel_driver());
  rig.device.reset();
  EXPECT_TRUE(rig.usbfs->kernel_driver());
}

TEST(UsbOpen, SaysWhatIsWrong) {
  WoodenModel model;
  UsbPort port(model);
  const auto protocol = [] { return std::make_unique<device::WoodenProtocol>(); };
  Usbfs usbfs(port);
  // A device of another kind.
  auto opened = device::UsbDevice::adopt(usbfs.descriptor(), device::kDevices[1], protocol());
  EXPECT_FALSE(opened.device);
  EXPECT_EQ(opened.fault, Fault::refused);
  EXPECT_NE(opened.error.find("another kind"), std::string::npos) << opened.error;
  // No USB device at all.
  opened = device::UsbDevice::adopt(0, device::kDevices[0], protocol());
  EXPECT_FALSE(opened.device);
  EXPECT_FALSE(opened.error.empty());
  // Gone meanwhile: libusb only says that it cannot talk with it.
  Usbfs other(port);
  port.unplug();
  opened = device::UsbDevice::adopt(other.descriptor(), device::kDevices[0], protocol());
  EXPECT_FALSE(opened.device);
  EXPECT_FALSE(opened.error.empty());
  // Options.
  device::UsbOptions options;
  options.rate = std::nan("");
  opened = device::UsbDevice::adopt(0, device::kDevices[0], protocol(), options);
  EXPECT_FALSE(opened.device);
  EXPECT_NE(opened.error.find("rate"), std::string::npos) << opened.error;
}

// A few bad packets among good ones are passed over.
TEST(UsbWooden, AFewBadPacketsAreNoFault) {
  Rig rig;
  ASSERT_TRUE(rig.reach(Phase::ready));
  for (const auto kind : {PacketFault::Kind::shorter, PacketFault::Kind::split, PacketFault::Kind::garbled}) {
    const std::uint32_t before = rig.drive(0.02, kPush).number;
    rig.port.packets({kind, 3});
    const Sample sample = rig.drive(0.1, kPush);
    EXPECT_EQ(sample.phase, Phase::ready);
    EXPECT_GT(sample.number, before + 5);
  }
}

// A device that takes no command for a moment gets none that is old, then the newest.
TEST(UsbWooden, ACommandThatIsStuckIsCalledBack) {
  Rig rig;
  ASSERT_TRUE(rig.reach(Phase::ready));
  rig.drive(0.03, kPush);
  rig.port.deafen();
  rig.drive(0.05, kPush);
  EXPECT_GT(rig.device->counts().blocked, 0u);
  const double heard = device::now();
  rig.drive(0.02, {0, 0, -1});  // still deaf: pushes that never leave
  rig.port.deafen(false);
  EXPECT_EQ(rig.drive(0.05, {0, 0, -1}).phase, Phase::ready);
  for (const Written& each : rig.port.log()) {
    // On the arm at home a push upwards and one to the side have currents of other signs.
    if (each.time > heard && !is_zero(each.bytes)) {
      EXPECT_LT(milliamps(each.bytes)[2], 0);
    }
  }
}

}  // namespace
}  // namespace palpate
