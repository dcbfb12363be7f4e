// SPDX-License-Identifier: GPL-3.0-or-later
// The loop by a clock of the test's own: rate, deadlines, lateness, ends; and by the real one for a moment.
#include "tests/device/loop/scripted_device.hpp"
#include "tests/runtime/allocation_counter.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <string>

namespace palpate::test {
namespace {

using device::Cause;
using device::ForceLoop;
using device::LoopOptions;
using device::LoopReport;
using device::Mode;
using device::StopFlags;

struct Bench {
  FakeClock clock;
  ScriptedDevice device{clock};
  KnownSource source;
  LoopOptions options;
  StopFlags stop;

  LoopReport run() {
    ForceLoop loop(device, source, options, stop, nullptr, clock);
    loop.run();
    return loop.report();
  }
};

double size(const Command& command) { return length(command.force); }

TEST(Loop, KeepsItsRateAndStopsWhenItsTimeIsOver) {
  for (const double rate : {1000.0, 4000.0}) {
    Bench bench;
    bench.options.safety.rate = rate;
    bench.options.seconds = 3;
    const LoopReport report = bench.run();
    EXPECT_EQ(report.out.mode, Mode::stopped);
    EXPECT_EQ(report.out.cause, Cause::asked);
    EXPECT_NEAR(report.rate(), rate, 1e-3 * rate);
    EXPECT_NEAR(static_cast<double>(report.ticks), 3.05 * rate, 3);
    EXPECT_EQ(report.missed, 0U);
    EXPECT_NEAR(report.period.mean(), 1 / rate, 1e-9);
    EXPECT_NEAR(report.peak_force, 2, 1e-9);
    EXPECT_EQ(size(bench.device.commands.back()), 0) << "the last command is zero";
  }
}

TEST(Loop, LatenessDoesNotAddUp) {
  Bench bench;
  bench.options.seconds = 10;
  bench.clock.oversleep = [](int k) { return k % 2 == 0 ? 4e-4 : 1e-5; };
  const LoopReport report = bench.run();
  EXPECT_NEAR(report.rate(), 1000, 1);
  EXPECT_EQ(report.missed, 0U);
  EXPECT_NEAR(report.late.most(), 4e-4, 1e-9);
  EXPECT_NEAR(report.late.quantile(0.5), 1e-5, 1e-6);
  EXPECT_NEAR(report.late.quantile(0.99), 4e-4, 4e-5);
}

TEST(Loop, MissedDeadlinesAreCountedAndNotMadeUpFor) {
  Bench bench;
  bench.options.seconds = 10;
  bench.clock.oversleep = [](int k) { return k % 100 == 0 ? 3.5e-3 : 0; };  // three deadlines each
  const LoopReport report = bench.run();
  EXPECT_NEAR(static_cast<double>(report.missed), 3 * static_cast<double>(report.ticks) / 100, 4);
  EXPECT_NEAR(static_cast<double>(report.ticks + report.missed), 10050, 5);
  for (std::size_t k = 1; k < bench.device.commands.size(); ++k) {
    ASSERT_GT(bench.device.commands[k].time - bench.device.commands[k - 1].time, 4.9e-4) << "a burst to catch up";
  }
}

TEST(Loop, AForceThatTakesTooLongToMakeEndsTheRun) {
  Bench bench;
  bench.device.work = 1.2e-3;  // of a millisecond
  const LoopReport report = bench.run();
  EXPECT_EQ(report.out.cause, Cause::deadlines);
  EXPECT_LT(report.elapsed, 0.3);
}

TEST(Loop, APauseTakesTheForceAndTheRampGivesItBack) {
  Bench bench;
  bench.options.seconds = 4;
  bench.clock.oversleep = [](int k) { return k == 1500 ? 0.05 : 0; };
  const LoopReport report = bench.run();
  EXPECT_EQ(report.late_ticks, 1U);
  EXPECT_EQ(report.suspensions, 1U);
  const auto& commands = bench.device.commands;
  EXPECT_EQ(size(commands[1498]), 2);
  EXPECT_EQ(size(commands[1499]), 0);
  EXPECT_LT(size(commands[1500]), 0.01);
  EXPECT_EQ(bench.source.resets, 1);
  EXPECT_EQ(report.peak_force, 2);
}

TEST(Loop, AgeOfSamplesIsMeasured) {
  Bench bench;
  bench.options.seconds = 2;
  bench.device.script = [](int, Sample& sample) { sample.time -= 0.002; };
  const LoopReport report = bench.run();
  EXPECT_NEAR(report.age.mean(), 0.002, 1e-9);
  EXPECT_EQ(report.stale_ticks, 0U);
}

TEST(Loop, AnUnpluggedDeviceEndsItAndIsNamed) {
  Bench bench;
  bench.device.script = [](int tick, Sample& sample) {
    if (tick > 1200) sample.phase = Phase::stopped, sample.fault = device::Fault::unplugged;
  };
  const LoopReport report = bench.run();
  EXPECT_EQ(report.ticks, 1201U);
  EXPECT_EQ(report.out.cause, Cause::device);
  EXPECT_EQ(report.out.fault, device::Fault::unplugged);
  EXPECT_EQ(size(bench.device.commands[1199]), 2);
  EXPECT_EQ(size(bench.device.commands[1200]), 0);
}

TEST(Loop, AnEmergencyStopIsZeroInTheNextTick) {
  Bench bench;
  bench.device.script = [&](int tick, Sample&) {
    if (tick == 1300) bench.stop.emergency_stop();
  };
  const LoopReport report = bench.run();
  EXPECT_EQ(report.ticks, 1300U);
  EXPECT_EQ(report.out.cause, Cause::emergency);
  EXPECT_EQ(size(bench.device.commands.back()), 0);
}

TEST(Loop, AllocatesNothing) {
  Bench bench;
  bench.options.seconds = 5;
  bench.device.script = [](int tick, Sample& sample) {
    if (tick % 1000 == 700) sample.time -= 1;  // through every branch that goes on
  };
  ForceLoop loop(bench.device, bench.source, bench.options, bench.stop, nullptr, bench.clock);
  const long before = allocations();
  loop.run();
  EXPECT_EQ(allocations() - before, 0);
  EXPECT_GT(loop.report().ticks, 5000U);
}

TEST(Loop, RunsByTheRealClockInAThreadOfItsOwn) {
  class LiveDevice : public device::Device {
  public:
    [[nodiscard]] const device::DeviceKind& kind() const override { return kind_; }
    Sample read() noexcept override {
      Sample sample;
      sample.time = device::now();
      sample.phase = Phase::ready;
      return sample;
    }
    void write(const Command& command) noexcept override { last = command; }
    void close() override {}
    Command last{0, {1, 1, 1}, {}};

  private:
    device::DeviceKind kind_{"live", 0, 0, 5, 1000, 0.1, 0.5};
  } device;
  KnownSource source;
  StopFlags stop;
  LoopOptions options;
  options.seconds = 0.2;
  options.realtime.lock_memory = false;  // what another test maps is none of ours
  options.safety.missed_share = 1;       // a machine that does much else
  ForceLoop loop(device, source, options, stop);
  const device::Realtime granted = loop.start();
  EXPECT_EQ(granted.fifo, granted.refused.empty()) << granted.refused;
  loop.join();
  EXPECT_FALSE(loop.running());
  EXPECT_GT(loop.report().ticks, 20U);
  EXPECT_EQ(loop.report().out.mode, Mode::stopped);
  EXPECT_EQ(length(device.last.force), 0);
}

TEST(Loop, WrongOptionsAreNamed) {
  LoopOptions options;
  EXPECT_EQ(options.validate(), nullptr);
  options.realtime.priority = 120;
  EXPECT_NE(std::string(options.validate()).find("priority"), std::string::npos);
  options = {};
  options.seconds = NAN;
  EXPECT_NE(options.validate(), nullptr);
}

TEST(Histogram, QuantilesAreRightToABin) {
  device::Histogram h;
  EXPECT_EQ(h.quantile(0.5), 0);
  for (int k = 1; k <= 1000; ++k) h.add(1e-6 * k);
  h.add(NAN);
  EXPECT_EQ(h.count(), 1000U);
  EXPECT_NEAR(h.mean(), 500.5e-6, 1e-12);
  for (const double share : {0.1, 0.5, 0.9, 0.99}) {
    EXPECT_GE(h.quantile(share), 1e-3 * share * (1 - 1e-9));
    EXPECT_LE(h.quantile(share), 1e-3 * share * 1.022);
  }
  EXPECT_EQ(h.quantile(1), 1e-3);
  h.add(100);  // beyond the last bin
  h.add(-1);
  EXPECT_EQ(h.most(), 100);
  EXPECT_EQ(h.least(), 0);
}

}  // namespace
}  // namespace palpate::test
