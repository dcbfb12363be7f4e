// SPDX-License-Identifier: GPL-3.0-or-later
// The whole life of every driver, through libusb, at either front end: plugged in, opened, claimed, booted or met,
// homed, driven, pulled out, plugged in again, closed.
#include "tests/device/usb/station.hpp"

namespace palpate::usb_life_test {
namespace {

using namespace test;
using device::Fault;
using device::Phase;
using device::Sample;
using device::Vec3;

constexpr Vec3 kPush{1, 2, 0.5};

class UsbLife : public UsbDrivers {
protected:
  // From power to a force.
  static void begin(Station& at) {
    at.plug(false);
    ASSERT_TRUE(at.open()) << at.opened.error;
    EXPECT_TRUE(at.front->claimed());
    ASSERT_TRUE(at.reach(Phase::homing, 20)) << device::name(at.device->read().fault);

    Sample sample = at.drive(0.1, kPush);
    if (at.held_up(sample)) return;
    EXPECT_EQ(sample.phase, Phase::homing) << "nobody has homed it";
    EXPECT_EQ(at.pushes_since(0), 0);
    EXPECT_FALSE(at.port.log().empty()) << "zeros are sent meanwhile";

    at.port.with_model([&] { at.subject->home(); });
    at.reach(Phase::ready);
    sample = at.push(kPush);
    if (at.held_up(sample)) return;
    ASSERT_EQ(sample.phase, Phase::ready) << device::name(sample.fault);
    EXPECT_LT(length(sample.pose.translation - at.subject->tip()), 1e-4);
    EXPECT_TRUE(at.holds_a_force(device::now()));
    for (const Written& each : at.port.log()) {
      if (at.subject->pushes(each.bytes)) {
        EXPECT_TRUE(at.subject->says(each.bytes, kPush));
      }
    }
  }

  static void pull_out(Station& at) {
    at.front->unplug();
    const Sample sample = at.drive(5, kPush);
    EXPECT_EQ(sample.phase, Phase::stopped);
    EXPECT_STREQ(device::name(sample.fault), device::name(Fault::unplugged));
    at.device->close();
    EXPECT_EQ(at.device->read().phase, Phase::closed);
    EXPECT_EQ(at.device->read().fault, Fault::unplugged);
    EXPECT_FALSE(at.device->counts().zero_left);
  }
};

TEST_P(UsbLife, FromPlugToPlug) {
  once_undisturbed([](Station& at) {
    for (int life = 0; life < 3 && !at.was_held_up && !HasFailure(); ++life) {
      begin(at);
      if (at.was_held_up || HasFatalFailure()) return;
      pull_out(at);
    }
  });
}

TEST_P(UsbLife, ClosesWithAZero) {
  once_undisturbed([](Station& at) {
    begin(at);
    if (at.was_held_up || HasFatalFailure()) return;
    at.device->close();
    const device::UsbCounts counts = at.device->counts();
    // The zero has 10 ms to leave, in which a slow front end does not always get there.
    at.was_held_up = !at.front->is_prompt() && !counts.zero_left;
    if (at.was_held_up) return;
    EXPECT_TRUE(counts.zero_left);
    EXPECT_FALSE(at.subject->pushes(at.port.log().back().bytes));
    EXPECT_FALSE(at.holds_a_force(device::now() + 0.001));
    EXPECT_EQ(at.device->read().phase, Phase::closed);
    EXPECT_EQ(at.device->read().fault, Fault::none);
    at.device->close();  // again: nothing
    at.device.reset();
    EXPECT_FALSE(at.front->claimed());
    begin(at);  // and a new life on the same socket
  });
}

TEST_P(UsbLife, IsPulledOutBeforeItIsReady) {
  for (const Phase phase : {Phase::starting, Phase::homing}) {
    once_undisturbed([=](Station& at) {
      at.plug(false);
      if (phase == Phase::starting) at.port.silence();
      ASSERT_TRUE(at.open()) << at.opened.error;
      ASSERT_TRUE(at.reach(phase, 20));
      if (at.held_up(at.drive(0.02, kPush))) return;
      pull_out(at);
      EXPECT_EQ(at.pushes_since(0), 0);
      at.plug(true);
      ASSERT_TRUE(at.open()) << at.opened.error;
      if (at.reach(Phase::ready) || at.held_up(at.device->read())) return;
      ADD_FAILURE() << "not ready: " << device::name(at.device->read().fault);
    });
  }
}

TEST_P(UsbLife, WhatAnotherProgramHasIsRefused) {
  Station at(GetParam());
  at.plug(true);
  at.front->take();
  EXPECT_FALSE(at.open());
  EXPECT_EQ(at.opened.fault, Fault::refused);
  EXPECT_NE(at.opened.error.find("claimed"), std::string::npos) << at.opened.error;
  at.plug(true);
  EXPECT_TRUE(at.open()) << at.opened.error;
}

// The force loop hangs: from 10 ms later on the device receives zeros and lets go.
TEST_P(UsbLife, AForceThatIsNotRenewedEnds) {
  once_undisturbed([](Station& at) {
    at.plug(true);
    ASSERT_TRUE(at.open()) << at.opened.error;
    at.reach(Phase::ready);
    if (at.held_up(at.push(kPush))) return;
    const std::uint64_t before = at.device->counts().stale;
    const double last = device::now();
    at.device->write({last, kPush, {}});
    Sample sample = at.device->read();
    while (sample.phase == Phase::ready && at.device->counts().stale < before + 10 && device::now() < last + 5) {
      pause(0.001);
      sample = at.device->read();
    }
    if (at.held_up(sample)) return;
    EXPECT_EQ(sample.phase, Phase::ready);
    EXPECT_GE(at.device->counts().stale, before + 10) << "zeros are still sent";
    // One may have been on its way when its time was over.
    EXPECT_LE(at.pushes_since(last + 0.010), 1);
    EXPECT_FALSE(at.holds_a_force(device::now()));
    const double again = device::now();
    sample = at.push(kPush);
    if (at.held_up(sample)) return;
    EXPECT_EQ(sample.phase, Phase::ready);
    EXPECT_GT(at.pushes_since(again), 0);
  });
}

INSTANTIATE_TEST_SUITE_P(Drivers, UsbLife, testing::ValuesIn(kDrivers),
                         [](const testing::TestParamInfo<const char*>& each) { return test_name(each.param); });

}  // namespace
}  // namespace palpate::usb_life_test
