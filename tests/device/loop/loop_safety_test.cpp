// SPDX-License-Identifier: GPL-3.0-or-later
// When there is a force and how much of it: every rule of the safety controller, each against the one fault that it is
// for.
#include "tests/device/loop/scripted_device.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace palpate::test {
namespace {

using device::Cause;
using device::Fault;
using device::Mode;
using device::SafetyController;
using device::SafetyLimits;
using device::TickInput;
using device::TickOutput;

constexpr double kPeriod = 1e-3;

/// Ticks of 1 ms with samples of half a millisecond, until a test says otherwise.
class SafetyRules : public testing::Test {
protected:
  TickOutput tick(const std::function<void(TickInput&)>& change = {}) {
    TickInput seen;
    seen.number = ++number_;
    seen.seconds = kPeriod;
    time_ += kPeriod;
    seen.time = time_;
    seen.sample.time = time_ - 0.0005;
    seen.sample.phase = Phase::ready;
    if (change) change(seen);
    return controller_.step(seen, source_);
  }
  TickOutput ticks(int count, const std::function<void(TickInput&)>& change = {}) {
    TickOutput out;
    for (int k = 0; k < count; ++k) out = tick(change);
    return out;
  }
  void engage() { ASSERT_EQ(ticks(1001).mode, Mode::engaged); }

  SafetyController controller_{SafetyLimits{}};
  KnownSource source_;

private:
  double time_ = 50;
  std::uint32_t number_ = 0;
};

double size(const TickOutput& out) { return length(out.command.force); }

TEST_F(SafetyRules, NoForceUntilTheDeviceIsReady) {
  for (const Phase phase : {Phase::closed, Phase::starting, Phase::homing}) {
    const TickOutput out = ticks(2000, [&](TickInput& seen) { seen.sample.phase = phase; });
    EXPECT_EQ(size(out), 0);
    EXPECT_EQ(out.mode, Mode::waiting);
    EXPECT_EQ(out.cause, Cause::not_ready);
  }
  EXPECT_GT(size(tick()), 0);
}

TEST_F(SafetyRules, TheForceGrowsOverTheRampAndNoFaster) {
  double before = 0;
  for (int k = 1; k <= 1000; ++k) {
    const TickOutput out = tick();
    ASSERT_NEAR(size(out), 2e-3 * k, 1e-9);
    ASSERT_LE(size(out) - before, 2e-3 + 1e-9);
    before = size(out);
  }
  EXPECT_EQ(tick().mode, Mode::engaged);
  EXPECT_EQ(size(tick()), 2);
}

TEST_F(SafetyRules, SaturationKeepsTheDirectionOfAnyForce) {
  engage();
  const Vec3 directions[] = {{1, 0, 0}, {-1, 2, -3}, {1e-3, -1, 1e-6}};
  for (const Vec3& d : directions) {
    for (const double newtons : {1e-6, 2.999, 3.0, 3.001, 40.0, 32768.0, 1e9, 1e150}) {
      const Vec3 u = (1 / length(d)) * d;
      source_.next.force = newtons * u;
      const TickOutput out = tick();
      ASSERT_NEAR(size(out), std::min(newtons, 3.0), 1e-9 * size(out));
      ASSERT_NEAR(length(out.command.force - size(out) * u), 0, 1e-9 * size(out));
    }
  }
}

TEST_F(SafetyRules, WhatIsNotFiniteIsNoForce) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    SafetyController controller{SafetyLimits{}};
    std::swap(controller, controller_);
    source_.next.force = {0, 0, 2};
    engage();
    source_.next.force = {0, bad, 0};
    const TickOutput out = tick();
    EXPECT_EQ(size(out), 0);
    EXPECT_EQ(out.cause, Cause::source);
  }
}

TEST_F(SafetyRules, TorqueIsLeftOutUnlessItHasALimit) {
  source_.next.torque = {0, 5, 0};
  engage();
  EXPECT_EQ(length(tick().command.torque), 0);
  SafetyLimits options;
  options.torque_limit = 0.1;
  controller_ = SafetyController(options);
  engage();
  EXPECT_NEAR(tick().command.torque.y, 0.1, 1e-12);
}

TEST_F(SafetyRules, AStaleSampleTakesTheForceAtOnceAndTheRampGivesItBack) {
  engage();
  EXPECT_GT(size(tick([](TickInput& seen) { seen.sample.time = seen.time - 0.0049; })), 0);
  for (const double age : {0.0051, 1.0, -0.1, std::numeric_limits<double>::quiet_NaN()}) {
    engage();
    const int resets = source_.resets;
    const TickOutput out = tick([&](TickInput& seen) { seen.sample.time = seen.time - age; });
    EXPECT_EQ(size(out), 0) << age;
    EXPECT_EQ(out.mode, Mode::suspended);
    EXPECT_EQ(out.cause, Cause::stale);
    EXPECT_EQ(source_.resets, resets + 1) << "a depth reached meanwhile must give no force back";
    EXPECT_LE(size(tick()), 2e-3 + 1e-9);
  }
}

TEST_F(SafetyRules, SilenceForHalfASecondIsTheEnd) {
  engage();
  const auto silent = [](TickInput& seen) { seen.sample.time = seen.time - 1; };
  EXPECT_EQ(ticks(499, silent).mode, Mode::suspended);
  const TickOutput out = ticks(3, silent);
  EXPECT_EQ(out.mode, Mode::stopped);
  EXPECT_EQ(out.cause, Cause::stale);
  EXPECT_EQ(tick().mode, Mode::stopped) << "it comes back too late";
}

TEST_F(SafetyRules, ALateTickGivesNoForce) {
  engage();
  for (const double seconds : {0.0101, 3.0, 0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    const TickOutput out = tick([&](TickInput& seen) { seen.seconds = seconds; });
    EXPECT_EQ(size(out), 0) << seconds;
  }
}

TEST_F(SafetyRules, APoseThatIsNoneGivesNoForce) {
  engage();
  const TickOutput out = tick([](TickInput& seen) { seen.sample.pose.translation.x = NAN; });
  EXPECT_EQ(size(out), 0);
  EXPECT_EQ(out.cause, Cause::pose);
  engage();
  EXPECT_EQ(size(tick([](TickInput& seen) { seen.sample.pose.rotation[0] = 2; })), 0);
}

TEST_F(SafetyRules, ATrackerThatDiesTakesTheForceAndThenTheRun) {
  engage();
  source_.next.usable = false;
  TickOutput out = tick();
  EXPECT_EQ(size(out), 0);
  EXPECT_EQ(out.mode, Mode::suspended);
  EXPECT_EQ(out.cause, Cause::source);
  out = ticks(600);
  EXPECT_EQ(out.mode, Mode::stopped);
}

TEST_F(SafetyRules, EmergencyStopsLatch) {
  const std::function<void(TickInput&)> stops[] = {
      [](TickInput& seen) { seen.requests = TickInput::emergency_stop; },
      [](TickInput& seen) { seen.sample.buttons = 8; },
      [](TickInput& seen) { seen.sample.phase = Phase::stopped, seen.sample.fault = Fault::unplugged; },
      [](TickInput& seen) { seen.sample.fault = Fault::impossible; }};
  const Cause causes[] = {Cause::emergency, Cause::button, Cause::device, Cause::device};
  for (int k = 0; k < 4; ++k) {
    controller_ = SafetyController(SafetyLimits{});
    engage();
    TickOutput out = tick(stops[k]);
    EXPECT_EQ(size(out), 0);
    out = ticks(5000);  // without another request
    EXPECT_EQ(out.mode, Mode::stopped);
    EXPECT_EQ(out.cause, causes[k]);
    EXPECT_EQ(size(out), 0);
    EXPECT_EQ(out.fault, k == 2 ? Fault::unplugged : k == 3 ? Fault::impossible : Fault::none);
  }
}

TEST_F(SafetyRules, OnlyTheButtonsThatAreNamedStop) {
  SafetyLimits options;
  options.stop_buttons = 2;
  controller_ = SafetyController(options);
  EXPECT_NE(tick([](TickInput& seen) { seen.sample.buttons = 1; }).mode, Mode::stopped);
  EXPECT_EQ(tick([](TickInput& seen) { seen.sample.buttons = 3; }).mode, Mode::stopped);
}

TEST_F(SafetyRules, AStopThatIsAskedForTakesTheForceByTheRamp) {
  engage();
  const auto stop = [](TickInput& seen) { seen.requests = TickInput::stop; };
  double before = 2;
  for (int k = 1; k < 50; ++k) {
    const TickOutput out = tick(k == 1 ? stop : std::function<void(TickInput&)>());  // one request is enough
    ASSERT_EQ(out.mode, Mode::stopping);
    ASSERT_LT(size(out), before);
    ASSERT_NEAR(size(out), 2 * (1 - k / 50.0), 1e-9);
    before = size(out);
  }
  const TickOutput out = ticks(2);
  EXPECT_EQ(out.mode, Mode::stopped);
  EXPECT_EQ(out.cause, Cause::asked);
}

TEST_F(SafetyRules, AStopBeforeAnyForceIsAtOnce) {
  const TickOutput out = tick([](TickInput& seen) {
    seen.sample.phase = Phase::homing;
    seen.requests = TickInput::stop;
  });
  EXPECT_EQ(out.mode, Mode::stopped);
  EXPECT_EQ(out.cause, Cause::asked);
}

TEST_F(SafetyRules, ATenthOfTheDeadlinesMayBeMissedInASecond) {
  engage();
  int number = 0;
  const auto every = [&](int nth) {
    return [&number, nth](TickInput& seen) { seen.missed = ++number % nth == 0 ? 1 : 0; };
  };
  EXPECT_EQ(ticks(5000, every(11)).mode, Mode::engaged);
  const TickOutput out = ticks(1100, every(9));
  EXPECT_EQ(out.mode, Mode::stopped);
  EXPECT_EQ(out.cause, Cause::deadlines);
}

TEST_F(SafetyRules, MissedDeadlinesCountBeforeThereIsAForceToo) {
  const TickOutput out = ticks(1100, [](TickInput& seen) {
    seen.sample.phase = Phase::homing;
    seen.missed = 1;
  });
  EXPECT_EQ(out.cause, Cause::deadlines);
}

TEST(SafetyLimits, EveryLimitIsChecked) {
  EXPECT_EQ(SafetyLimits{}.validate(), nullptr);
  const auto refuses = [](const char* word, auto change) {
    SafetyLimits options;
    change(options);
    const char* wrong = options.validate();
    ASSERT_NE(wrong, nullptr) << word;
    EXPECT_NE(std::string(wrong).find(word), std::string::npos) << wrong;
  };
  for (const double bad : {-1.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    refuses("rate", [&](SafetyLimits& o) { o.rate = bad; });
    refuses("limit of the force", [&](SafetyLimits& o) { o.limit = bad; });
    refuses("limit of the torque", [&](SafetyLimits& o) { o.torque_limit = bad; });
    refuses("ramp up", [&](SafetyLimits& o) { o.ramp_up = bad; });
    refuses("ramp down", [&](SafetyLimits& o) { o.ramp_down = bad; });
    refuses("stale", [&](SafetyLimits& o) { o.stale = bad; });
    refuses("gap", [&](SafetyLimits& o) { o.gap = bad; });
    refuses("usable", [&](SafetyLimits& o) { o.silent = bad; });
    refuses("missed", [&](SafetyLimits& o) { o.missed_share = bad; });
  }
  refuses("stale", [](SafetyLimits& o) { o.stale = 0.02; });
}

}  // namespace
}  // namespace palpate::test
