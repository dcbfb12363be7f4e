// SPDX-License-Identifier: GPL-3.0-or-later
// The WoodenHaptics language in exact time: reports, homing, doubt, and every way to stop.
#include "device/wooden_haptics/wooden_protocol.hpp"
#include "tests/device/models/wooden_model.hpp"
#include "tests/device/try_protocol.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace palpate::wooden_protocol_test {
namespace {

using namespace device;
using test::Bytes;
using test::WoodenModel;

constexpr double kTick = 1e-3;  // s
constexpr double kPi = 3.141592653589793;

// Board and protocol with nothing between them, in steps of a millisecond.
struct Bench {
  explicit Bench(const WoodenOptions& options = {}) : protocol(options) {
    model.plugged(time);
    protocol.start(time);
  }
  void step(const Vec3& force) {
    time += kTick;
    Bytes packet;
    if (model.read(time, packet) && hears) protocol.received(time, packet.data(), packet.size());
    sent = protocol.next(time, {time, force, {}});
    if (sent.kind != Request::Kind::write) return;
    if (takes) model.written(time, Bytes(sent.bytes, sent.bytes + sent.size));
    protocol.ended(time, takes ? Outcome::done : Outcome::timed_out);
  }
  void run(double seconds, const Vec3& force = {}) {
    for (double left = seconds; left > 0; left -= kTick) step(force);
  }
  bool home() {
    run(1.1);
    return protocol.sample().phase == Phase::ready;
  }
  /// s until zero is sent, and until it stops; -1: never.
  struct End {
    double zero = -1, stopped = -1;
  };
  End until_stopped(const Vec3& force) {
    End end;
    const double begun = time;
    while (time - begun < 1 && end.stopped < 0) {
      step(force);
      const bool zero = std::all_of(sent.bytes, sent.bytes + sent.size, [](std::uint8_t byte) { return byte == 0; });
      if (zero && end.zero < 0) end.zero = time - begun;
      if (!zero) end.zero = -1;
      if (protocol.sample().phase == Phase::stopped) end.stopped = time - begun;
    }
    return end;
  }

  WoodenModel model;
  WoodenProtocol protocol;
  double time = 5;
  Request sent;
  bool hears = true, takes = true;
};

TEST(WoodenProtocol, IsReadyOnceItWasHeldStill) {
  Bench bench;
  bench.run(0.9, {1, 1, 1});
  EXPECT_EQ(bench.protocol.sample().phase, Phase::homing);
  EXPECT_EQ(bench.model.milliamps(bench.time), (std::array<int, 3>{}));
  // Nudged: the second begins anew.
  bench.model.leap(100);
  bench.run(0.9, {1, 1, 1});
  EXPECT_EQ(bench.protocol.sample().phase, Phase::homing);
  bench.run(0.2, {1, 1, 1});
  EXPECT_EQ(bench.protocol.sample().phase, Phase::ready);
  EXPECT_NE(bench.model.milliamps(bench.time), (std::array<int, 3>{}));
  const Vec3 home = position(WoodenGeometry{}, {0, 0, kPi / 2});
  EXPECT_LT(length(bench.protocol.sample().pose.translation - home), 1e-12);
  EXPECT_GT(bench.protocol.sample().number, 1900u);
}

TEST(WoodenProtocol, FollowsEncodersRoundAndRound) {
  Bench bench;
  // 65536 counts of the column are 12.9 rad: it turns by 40 rad and back, at 4 rad/s.
  bench.model.motion = [](double t) { return Joints{20 * (1 - std::cos(0.2 * std::max(t - 1.2, 0.0))), 0, kPi / 2}; };
  ASSERT_TRUE(bench.home());
  double worst = 0;
  for (int k = 0; k < 31000; ++k) {
    bench.step({0, 0, 1});
    const Vec3 at = position(bench.model.geometry, bench.model.angles(bench.time));
    worst = std::max(worst, length(bench.protocol.sample().pose.translation - at));
  }
  EXPECT_EQ(bench.protocol.sample().phase, Phase::ready);
  EXPECT_LT(worst, 1e-4);  // a count of the column at the arm's length: 0.05 mm
}

TEST(WoodenProtocol, SilenceBringsZeroThenAFault) {
  Bench bench;
  ASSERT_TRUE(bench.home());
  bench.run(0.1, {1, 1, 1});
  bench.hears = false;
  const Bench::End end = bench.until_stopped({1, 1, 1});
  EXPECT_LE(end.zero, 0.010);
  EXPECT_NEAR(end.stopped, 0.021, 1.5e-3);
  EXPECT_EQ(bench.protocol.sample().fault, Fault::silent);
}

TEST(WoodenProtocol, TheSameReportAgainIsSilence) {
  Bench bench;
  ASSERT_TRUE(bench.home());
  Bytes packet;
  ASSERT_TRUE(bench.model.read(bench.time + kTick, packet));
  for (int k = 0; k < 30; ++k) {
    bench.time += kTick;
    bench.protocol.received(bench.time, packet.data(), packet.size());
    bench.protocol.next(bench.time, {});
    bench.protocol.ended(bench.time, Outcome::done);
  }
  EXPECT_EQ(bench.protocol.sample().fault, Fault::silent);
}

TEST(WoodenProtocol, OtherSizesAreNoReports) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{9}, std::size_t{63}}) {
    Bench bench;
    ASSERT_TRUE(bench.home());
    bench.hears = false;
    const Bytes noise(size, 0x55);
    double zero = -1, stopped = -1;
    for (int k = 1; k < 40 && stopped < 0; ++k) {
      bench.protocol.received(bench.time, noise.data(), noise.size());
      bench.step({1, 1, 1});
      if (zero < 0 && bench.sent.bytes[0] == 0 && bench.sent.bytes[4] == 0) zero = k * kTick;
      if (bench.protocol.sample().phase == Phase::stopped) stopped = k * kTick;
    }
    EXPECT_LE(zero, 0.010);
    EXPECT_NEAR(stopped, 0.021, 1.5e-3);
    EXPECT_EQ(bench.protocol.sample().fault, Fault::garbled);
  }
}

TEST(WoodenProtocol, ALeapThatNoArmMakesEndsIt) {
  Bench bench;
  ASSERT_TRUE(bench.home());
  bench.run(0.1, {1, 1, 1});
  const Vec3 before = bench.protocol.sample().pose.translation;
  bench.model.leap(-700);  // 0.14 rad of an upper body in a millisecond
  const Bench::End end = bench.until_stopped({1, 1, 1});
  EXPECT_LE(end.zero, 0.0015);
  EXPECT_EQ(bench.protocol.sample().fault, Fault::impossible);
  EXPECT_EQ(length(bench.protocol.sample().pose.translation - before), 0);
}

TEST(WoodenProtocol, AnArmFoldedThroughItselfWasHomedElsewhere) {
  Bench bench;
  bench.model.motion = [](double t) { return Joints{0, -2 * std::max(t - 1.2, 0.0), kPi / 2}; };
  ASSERT_TRUE(bench.home());
  EXPECT_GT(bench.until_stopped({0, 0, 1}).stopped, 0.5);
  EXPECT_EQ(bench.protocol.sample().fault, Fault::impossible);
}

TEST(WoodenProtocol, ABoardThatTakesNothingIsStalled) {
  Bench bench;
  ASSERT_TRUE(bench.home());
  bench.takes = false;
  EXPECT_NEAR(bench.until_stopped({1, 1, 1}).stopped, 0.021, 1.5e-3);
  EXPECT_EQ(bench.protocol.sample().fault, Fault::stalled);
}

// A host that was away for a while finds what came meanwhile first, and goes on.
TEST(WoodenProtocol, AHostThatSleptIsNoFaultOfTheBoard) {
  Bench bench;
  ASSERT_TRUE(bench.home());
  bench.run(0.1, {1, 1, 1});
  bench.time += 0.3;
  bench.run(0.01, {1, 1, 1});
  EXPECT_EQ(bench.protocol.sample().phase, Phase::ready) << name(bench.protocol.sample().fault);
  EXPECT_NE(bench.model.milliamps(bench.time), (std::array<int, 3>{}));
}

// Reports that waited while the host slept are of one moment, however long it slept between reading two of them.
TEST(WoodenProtocol, AHostThatSleptHasNotSeenItHeldStill) {
  Bench bench;
  bench.model.motion = [](double time) {
    return Joints{0, 0.03 * std::cos(20 * time), kPi / 2 + 0.03 * std::sin(20 * time)};
  };
  bench.run(0.5);
  ASSERT_EQ(bench.protocol.sample().phase, Phase::homing);
  Bytes waited[2];
  for (Bytes& each : waited) ASSERT_TRUE(bench.model.read(bench.time += kTick, each));
  for (const Bytes& each : waited) bench.protocol.received(bench.time += 5, each.data(), each.size());
  EXPECT_EQ(bench.protocol.sample().phase, Phase::homing);
}

TEST(WoodenProtocol, ABoardThatNeverReportsIsSilent) {
  Bench bench;
  bench.hears = false;
  bench.run(1.9);
  EXPECT_EQ(bench.protocol.sample().phase, Phase::starting);
  bench.run(0.2);
  EXPECT_EQ(bench.protocol.sample().fault, Fault::silent);
}

TEST(WoodenCodec, CurrentsKeepTheirDirectionAndNeverWrap) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 20000; ++k) {
    const double scale = std::pow(10.0, static_cast<int>(random() % 12) - 3);
    const Joints amps{scale * normal(random), scale * normal(random), scale * normal(random)};
    const auto out = milliamps(amps, 3.0);
    double largest = 0;
    for (const double each : amps) largest = std::max(largest, std::fabs(each));
    const double factor = 1000 * std::min(1.0, 3 / largest);
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_LE(std::abs(out[i]), 3000);
      ASSERT_NEAR(out[i], factor * amps[i], 0.5 + 1e-9);
    }
  }
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(milliamps({infinite, 1, 1}, 3), (std::array<std::int16_t, 3>{}));
  EXPECT_EQ(milliamps({1, std::nan(""), 1}, 3), (std::array<std::int16_t, 3>{}));
  EXPECT_EQ(milliamps({1e300, 1e300, 0}, 3), (std::array<std::int16_t, 3>{3000, 3000, 0}));
}

TEST(WoodenCodec, ReportsAreLittleEndianAndMayBePadded) {
  std::uint8_t bytes[64] = {0x01, 0x80, 0xff, 0x7f, 0xfe, 0xff, 0x34, 0x12};
  WoodenReport report;
  ASSERT_TRUE(decode(bytes, 8, report));
  EXPECT_EQ(report.encoder[0], -32767);
  EXPECT_EQ(report.encoder[1], 32767);
  EXPECT_EQ(report.encoder[2], -2);
  EXPECT_EQ(report.number, 0x1234);
  EXPECT_TRUE(decode(bytes, 64, report));
  bytes[40] = 1;
  EXPECT_FALSE(decode(bytes, 64, report));
  EXPECT_FALSE(decode(bytes, 7, report));
  EXPECT_FALSE(decode(bytes, 0, report));
  bytes[40] = 0;
  EXPECT_FALSE(is_six_joint_report(bytes, 8) || is_six_joint_report(bytes, 64));
  EXPECT_TRUE(is_six_joint_report(bytes, 14)) << "for any state of the wrist";
  bytes[9] = 1;
  EXPECT_TRUE(is_six_joint_report(bytes, 64));
  std::uint8_t out[kWoodenReport];
  encode({1, -1, -32768}, out);
  const std::uint8_t expected[] = {1, 0, 0xff, 0xff, 0, 0x80, 0, 0};
  EXPECT_TRUE(std::equal(std::begin(out), std::end(out), expected));
}

TEST(WoodenOptions, SaysWhatIsWrong) {
  EXPECT_EQ(WoodenOptions{}.validate(), nullptr);
  const auto wrong = [](auto change) {
    WoodenOptions options;
    change(options);
    return options.validate() != nullptr;
  };
  EXPECT_TRUE(wrong([](WoodenOptions& o) { o.geometry.lower = 0; }));
  EXPECT_TRUE(wrong([](WoodenOptions& o) { o.home[1] = std::nan(""); }));
  EXPECT_TRUE(wrong([](WoodenOptions& o) { o.hold = 0; }));
  EXPECT_TRUE(wrong([](WoodenOptions& o) { o.most_current = 33; }));
  EXPECT_TRUE(wrong([](WoodenOptions& o) { o.silence = 0.5 * o.doubtful; }));
  EXPECT_TRUE(wrong([](WoodenOptions& o) { o.fold = -1; }));
}

// Random scripts, some of them made of real reports so that they come further than homing.
TEST(WoodenProtocol, KeepsItsPromisesOnAnyBytes) {
  std::mt19937 random(13);
  int ready = 0;
  for (int k = 0; k < 3000; ++k) {
    WoodenOptions options;
    options.hold = 0.01;
    WoodenProtocol protocol(options);
    Bytes script;
    const bool sense = k % 3 != 0;
    std::uint16_t number = 0;
    std::int16_t at = static_cast<std::int16_t>(random());
    for (int event = 0; event < 100; ++event) {
      if (sense && random() % 50 != 0) {
        at = static_cast<std::int16_t>(at + (event > 40 ? static_cast<int>(random() % 100) - 50 : 0));
        const auto word = static_cast<std::uint16_t>(at);
        script.insert(script.end(), {0x40, 8});
        for (int axis = 0; axis < 3; ++axis) {
          script.push_back(static_cast<std::uint8_t>(word & 0xff));
          script.push_back(static_cast<std::uint8_t>(word >> 8));
        }
        ++number;
        script.push_back(static_cast<std::uint8_t>(number & 0xff));
        script.push_back(static_cast<std::uint8_t>(number >> 8));
        script.push_back(0x0c);
      } else {
        for (auto bytes = random() % 12; bytes > 0; --bytes) script.push_back(static_cast<std::uint8_t>(random()));
      }
    }
    const char* broken = test::try_protocol(protocol, kDevices[0], script.data(), script.size());
    ASSERT_EQ(broken, nullptr) << broken << " in script " << k;
    ready += protocol.sample().number > 50 && length(protocol.sample().pose.translation) > 0;
  }
  EXPECT_GT(ready, 300);
}

}  // namespace
}  // namespace palpate::wooden_protocol_test
