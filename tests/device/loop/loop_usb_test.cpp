// SPDX-License-Identifier: GPL-3.0-or-later
// The force loop over the real libusb path and an emulated board: what reaches the wire when something goes wrong.
#include "tests/device/loop/scripted_device.hpp"
#include "tests/device/usb/rig.hpp"

#include <gtest/gtest.h>

#include <atomic>

namespace palpate {
namespace {

using namespace test;
using device::Cause;
using device::Fault;
using device::LoopOptions;
using device::LoopReport;
using device::Mode;
using device::Phase;

/// The same force always, but for the ticks in which it hangs.
class Pushing : public device::ForceSource {
public:
  device::Answer answer(const device::Sample&, double) noexcept override {
    if (hang > 0) pause(hang.exchange(0));
    return KnownSource::forceful({1, 2, 1});
  }
  void reset() noexcept override {}
  std::atomic<double> hang{0};  ///< s
};

/// The device's thread is as prompt as the loop's, where that is permitted.
device::UsbOptions prompt() {
  device::UsbOptions options;
  options.priority = 80;
  return options;
}

class LoopUsb : public testing::Test {
protected:
  LoopUsb() {
    options_.safety.ramp_up = 0.01;
    options_.safety.missed_share = 1;  // a machine that does much else
    options_.safety.stale = device::kStale;
    options_.realtime.lock_memory = false;
  }

  /// Runs until there is a force on the wire, then does `then`, and waits for the loop to end (or for so long, s).
  LoopReport run(Rig& rig, const std::function<void()>& then, double most = 3) {
    device::StopFlags stop;
    stop_ = &stop;
    device::ForceLoop loop(*rig.device, source_, options_, stop);
    loop.start();
    const double end = device::now() + 5;
    const std::array<int, 3> none{};
    while (device::now() < end && rig.last_push() == none) pause(0.001);
    EXPECT_NE(rig.last_push(), none);
    pause(0.05);
    begun_ = device::now();
    then();
    for (const double over = device::now() + most; loop.running() && device::now() < over;) pause(0.001);
    ended_ = !loop.running();
    stop.emergency_stop();
    loop.join();
    return loop.report();
  }

  /// s from `begun_` to the first zero on the wire after it.
  [[nodiscard]] double first_zero(const Rig& rig) const {
    for (const Written& each : rig.port.log()) {
      if (each.time > begun_ && is_zero(each.bytes)) return each.time - begun_;
    }
    return 1e9;
  }

  LoopOptions options_;
  Pushing source_;
  device::StopFlags* stop_ = nullptr;
  double begun_ = 0;  ///< s, of `then`
  bool ended_ = false;
};

// A machine that does much else may hold any thread up for longer: the best of some trials counts.
constexpr int kTrials = 6;
constexpr double kAtMost = 0.025;  // s: 10 ms of the rules, and the emulated bus

TEST_F(LoopUsb, AnEmergencyStopIsOnTheWireAtOnce) {
  double best = 1;
  for (int k = 0; k < kTrials && best > kAtMost; ++k) {
    Rig rig(prompt(), quick_homing());
    ASSERT_TRUE(rig.device) << rig.opened.error;
    const LoopReport report = run(rig, [&] { stop_->emergency_stop(); });
    ASSERT_TRUE(ended_);
    EXPECT_EQ(report.out.cause, Cause::emergency);
    best = std::min(best, first_zero(rig));
    rig.device->close();
    EXPECT_TRUE(is_zero(rig.port.log().back().bytes));
  }
  EXPECT_LE(best, kAtMost);
}

TEST_F(LoopUsb, AForceThatHangsIsReplacedByZeroByTheOtherThread) {
  double best = 1;
  for (int k = 0; k < kTrials && best > kAtMost; ++k) {
    Rig rig(prompt(), quick_homing());
    ASSERT_TRUE(rig.device) << rig.opened.error;
    const LoopReport report = run(
        rig, [&] { source_.hang = 0.2; }, 0.3);
    EXPECT_GE(report.late_ticks, 1U);
    EXPECT_GE(report.suspensions, 1U);
    EXPECT_GE(report.missed, 150U);
    EXPECT_GE(rig.device->counts().stale, 1U);
    best = std::min(best, first_zero(rig));
  }
  EXPECT_LE(best, kAtMost);
}

TEST_F(LoopUsb, AFaultOnTheWireEndsTheRunByItsName) {
  struct Case {
    Fault fault;
    void (*inject)(Rig&);
    bool zero;  ///< comes through
  };
  const Case cases[] = {{Fault::stalled, [](Rig& rig) { rig.port.stall_input(); }, true},
                        {Fault::unplugged, [](Rig& rig) { rig.port.unplug(); }, false}};
  for (const Case& each : cases) {
    Rig rig(prompt(), quick_homing());
    ASSERT_TRUE(rig.device) << rig.opened.error;
    const LoopReport report = run(rig, [&] { each.inject(rig); });
    ASSERT_TRUE(ended_) << device::name(each.fault) << ": " << name(report.out.mode) << ", " << name(report.out.cause)
                        << "; the device is " << device::name(report.seen.sample.phase);
    EXPECT_EQ(report.out.mode, Mode::stopped);
    EXPECT_EQ(report.out.cause, Cause::device);
    EXPECT_STREQ(device::name(report.out.fault), device::name(each.fault));
    EXPECT_EQ(length(report.out.command.force), 0);
    rig.device->close();
    EXPECT_EQ(is_zero(rig.port.log().back().bytes), each.zero);
    EXPECT_EQ(rig.device->counts().zero_left, each.zero);
  }
}

TEST_F(LoopUsb, SilenceOfTheBoardTakesTheForceBeforeItEndsTheRun) {
  Rig rig(prompt(), quick_homing());  // the driver itself is patient: a second
  ASSERT_TRUE(rig.device) << rig.opened.error;
  const LoopReport report = run(rig, [&] { rig.port.silence(); });
  ASSERT_TRUE(ended_);
  EXPECT_TRUE(report.out.cause == Cause::stale || report.out.cause == Cause::device) << name(report.out.cause);
  EXPECT_GE(report.stale_ticks, 1U);
  EXPECT_GE(report.suspensions, 1U);
  rig.device->close();
  EXPECT_TRUE(is_zero(rig.port.log().back().bytes));
}

}  // namespace
}  // namespace palpate
