// SPDX-License-Identifier: GPL-3.0-or-later
// The simulated device's life, step by step: homing, stale commands, silence, unplugging, closing; once by the clock.
#include "device/simulation/sim_device.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

namespace palpate::device {
namespace {

/// A simulated device without a clock, opened and moved on to ready.
struct Stepped {
  SimDevice device;
  double time = 0;
  explicit Stepped(const char* name = "sim")
      : device(find_sim_kind(name)->kind, find_sim_kind(name)->plant, SimOptions{}, nullptr) {}
  void step(const Vec3& force, double seconds = 0.001) {
    device.advance(time += seconds);
    device.read();
    device.write({time, force, {}});
  }
  void make_ready() {
    while (device.read().phase != Phase::ready) step({});
  }
  [[nodiscard]] double force() const { return length(device.plant().force()); }
};

TEST(SimKinds, AreFoundByTheirNamesAndUsable) {
  std::set<std::string> names;
  for (const SimKind& kind : sim_kinds()) {
    EXPECT_EQ(find_sim_kind(kind.kind.name), &kind);
    EXPECT_TRUE(names.insert(kind.kind.name).second);
    EXPECT_EQ(kind.plant.validate().value_or(""), "") << kind.kind.name;
    EXPECT_EQ(kind.plant.peak_force, kind.kind.peak_force);
    EXPECT_EQ(find_kind(kind.kind.vendor, kind.kind.product), nullptr);
  }
  EXPECT_EQ(std::string(sim_kinds().front().kind.name), "sim");
  EXPECT_EQ(find_sim_kind("no such device"), nullptr);
}

TEST(SimDevice, StartsHomesAndIsReady) {
  Stepped s;
  EXPECT_EQ(s.device.read().phase, Phase::starting);
  EXPECT_EQ(s.device.read().number, 0u);
  s.device.advance(s.time = 0.1);
  Sample sample = s.device.read();
  EXPECT_EQ(sample.phase, Phase::homing);
  EXPECT_GT(length(sample.pose.translation), 0.01);  // no origin yet
  // No force before it is ready, whatever the loop says.
  while (s.device.read().phase == Phase::homing) {
    s.step({1, 0, 0});
    if (s.device.read().phase == Phase::homing) {
      EXPECT_EQ(s.force(), 0);
    }
  }
  sample = s.device.read();
  EXPECT_EQ(sample.phase, Phase::ready);
  EXPECT_NEAR(s.time, 0.3, 0.002);
  EXPECT_LT(length(sample.pose.translation), 1e-3);
  const std::uint32_t number = sample.number;
  EXPECT_EQ(s.device.read().number, number);  // no time, no new sample
  s.device.press(5);
  s.step({});
  EXPECT_EQ(s.device.read().number, number + 1);
  EXPECT_EQ(s.device.read().buttons, 5u);
  EXPECT_EQ(s.device.read().time, s.time);
}

TEST(SimDevice, PushesAndLetsGoOfStaleCommands) {
  Stepped s;
  s.make_ready();
  for (int k = 0; k < 5; ++k) s.step({0, 0, 80});
  EXPECT_NEAR(s.force(), s.device.kind().peak_force, 1e-12);
  s.device.advance(s.time + 0.0095);
  EXPECT_GT(s.force(), 0);
  s.device.advance(s.time + 0.012);
  EXPECT_EQ(s.force(), 0);
  EXPECT_EQ(s.device.read().phase, Phase::ready);
  s.time += 0.012;
  s.step({0, 0, 1});
  s.step({0, 0, 1});
  EXPECT_EQ(s.force(), 1);
  // A command that was old before it was written counts as none.
  s.device.advance(s.time += 0.001);
  s.device.write({s.time - 0.011, {0, 0, 2}, {}});
  s.device.advance(s.time + 0.001);
  EXPECT_EQ(s.force(), 0);
}

TEST(SimDevice, SilenceEndsInZeroWithinTenMilliseconds) {
  Stepped s;
  s.make_ready();
  for (int k = 0; k < 5; ++k) s.step({0, 0, 2});
  s.device.fall_silent();
  const double fell = s.time;
  const std::uint32_t number = s.device.read().number;
  while (s.device.read().phase == Phase::ready && s.time < fell + 1) s.step({0, 0, 2});
  EXPECT_LE(s.time - fell, 0.0065);
  EXPECT_EQ(s.device.read().fault, Fault::silent);
  EXPECT_EQ(s.device.read().number, number);
  while (s.time < fell + 0.0099) s.step({0, 0, 2}, 0.0005);  // nothing revives it
  EXPECT_EQ(s.force(), 0);
}

TEST(SimDevice, UnpluggedItsOwnWatchdogEndsTheForce) {
  for (const char* name : {"sim", "sim-falcon"}) {
    Stepped s(name);
    s.make_ready();
    for (int k = 0; k < 5; ++k) s.step({0, 0, 2});
    s.device.unplug();
    s.step({0, 0, 1});
    EXPECT_EQ(s.device.read().phase, Phase::stopped);
    EXPECT_EQ(s.device.read().fault, Fault::unplugged);
    const double left = s.time - 0.001 + s.device.kind().watchdog;
    while (s.time < left + 0.01) {
      if (s.time < left) {
        EXPECT_EQ(s.force(), 2) << s.time;
      }
      s.step({});
    }
    EXPECT_EQ(s.force(), s.device.kind().watchdog > 0 ? 0 : 2);  // a Falcon has none that is known
  }
}

TEST(SimDevice, ClosesWithZeroForce) {
  Stepped s;
  s.make_ready();
  for (int k = 0; k < 5; ++k) s.step({0, 0, 2});
  s.device.close();
  EXPECT_EQ(s.force(), 0);
  EXPECT_EQ(s.device.read().phase, Phase::closed);
  s.device.close();
  s.step({0, 0, 2});
  EXPECT_EQ(s.force(), 0);
}

TEST(SimDevice, MovesOnWithTheClock) {
  SimOptions options;
  options.starting = options.homing = 0.005;
  SimDevice device(find_sim_kind("sim")->kind, find_sim_kind("sim")->plant, options);
  const double opened = now();
  while (device.read().phase != Phase::ready && now() < opened + 10)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ASSERT_EQ(device.read().phase, Phase::ready);
  device.write({now(), {0, 0, 1}, {}});
  std::this_thread::sleep_for(std::chrono::milliseconds(3));
  EXPECT_GT(device.read().pose.translation.z, 0);
  EXPECT_NEAR(device.read().time, now(), 0.5);
}

double jumping_clock = 100;

TEST(SimDevice, SkipsWhatAStoppedProgramHasMissed) {
  jumping_clock = 100;
  SimDevice device(find_sim_kind("sim")->kind, find_sim_kind("sim")->plant, {}, [] { return jumping_clock; });
  jumping_clock = 100.4;
  EXPECT_EQ(device.read().phase, Phase::ready);
  device.write({jumping_clock, {0, 0, 1}, {}});
  jumping_clock = 4000;
  EXPECT_EQ(device.read().time, 4000);
  EXPECT_LT(device.plant().time(), 1.0);
  EXPECT_EQ(length(device.plant().force()), 0);
}

TEST(SimOptions, SayWhatIsWrong) {
  SimOptions options;
  EXPECT_FALSE(options.validate());
  options.silent_after = 0.02;
  EXPECT_TRUE(options.validate());
  EXPECT_THROW(SimDevice(sim_kinds()[0].kind, sim_kinds()[0].plant, options), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::device
