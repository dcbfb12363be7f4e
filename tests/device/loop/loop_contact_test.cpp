// SPDX-License-Identifier: GPL-3.0-or-later
// The loop on baked bodies: the contact's own forces through the frame, a simulated device, a tracker that dies.
#include "device/loop/contact_source.hpp"
#include "device/loop/tracked_source.hpp"
#include "device/simulation/sim_device.hpp"
#include "tests/device/loop/scripted_device.hpp"
#include "tests/runtime/support.hpp"

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

namespace palpate::test {
namespace {

using device::Cause;
using device::ContactSource;
using device::LoopOptions;
using device::Mode;
using runtime::DeviceFrame;

// The device's z axis is the scene's x; its origin lies over the ball's side; a metre of the hand is half one of the
// scene.
DeviceFrame sideways() {
  DeviceFrame frame;
  frame.pose = Pose::from_quaternion(std::sqrt(0.5), 0, std::sqrt(0.5), 0, {kBallRadius + kTipRadius + 0.002, 0, 0});
  frame.scale = 0.5;
  frame.force_scale = 2;
  return frame;
}

Sample sample_at(const Vec3& position) {
  Sample sample;
  sample.pose = upright(position);
  return sample;
}

TEST(LoopContact, IsTheContactsForceInTheDevicesFrame) {
  const Opened ball(ball_content({}));
  ContactSource<> source(ball.view, 0, sideways());
  runtime::Contact contact(ball.view, 0);
  double largest = 0;
  for (int k = 0; k < 2000; ++k) {
    const Sample hand = sample_at({0.002 * std::sin(0.01 * k), 0, -0.012 * std::sin(0.003 * k)});
    const device::Answer answer = source.answer(hand, 1e-3);
    const Tick tick = contact.tick(sideways().to_scene(hand.pose));
    ASSERT_TRUE(answer.usable);
    ASSERT_EQ(answer.depth, tick.depth);
    // Device z is scene x, device x is scene -z.
    ASSERT_NEAR(answer.force.z, 2 * tick.force.x, 1e-12);
    ASSERT_NEAR(answer.force.x, -2 * tick.force.z, 1e-12);
    ASSERT_NEAR(answer.force.y, 2 * tick.force.y, 1e-12);
    ASSERT_NEAR(answer.torque.z, 4 * tick.torque.x, 1e-12);
    ASSERT_NEAR(answer.torque.x, -4 * tick.torque.z, 1e-12);
    ASSERT_NEAR(answer.torque.y, 4 * tick.torque.y, 1e-12);
    largest = std::max(largest, answer.force.z);
  }
  EXPECT_GT(largest, 0.5);
  EXPECT_FALSE(source.answer(sample_at({NAN, 0, 0}), 1e-3).usable);
}

// A stem that moves and turns on the ball, and as many newtons on the hand as metres of the scene for one of its own.
TEST(LoopContact, TheHandDoesTheScenesWorkByMovesAndTurns) {
  ResponseSampleOptions options;
  options.tools = ResponseSampleOptions::Tools::capsule;
  const Opened ball(ball_content(options));
  DeviceFrame frame = sideways();
  frame.scale = frame.force_scale = 3;
  ContactSource<> source(ball.view, 0, frame);
  runtime::EnergyMeter hand, scene, without_torque;
  for (int k = 0; k < 4000; ++k) {
    const double t = 1e-3 * k;
    Sample sample;
    sample.pose = Pose::from_quaternion(1, 0.03 * std::sin(5 * t), 0.04 * std::sin(3 * t), 0,
                                        {3e-4 * std::sin(7 * t), 0, -0.0015 * std::sin(4 * t)});
    const device::Answer answer = source.answer(sample, 1e-3);
    ASSERT_TRUE(answer.usable);
    Tick felt;
    felt.force = answer.force;
    without_torque.add(sample.pose, felt);
    felt.torque = answer.torque;
    hand.add(sample.pose, felt);
    scene.add(frame.to_scene(sample.pose), source.tick());
  }
  // The comparison below sees a wrong torque: the torque does more than a thousandth of the work.
  EXPECT_GT(std::abs(without_torque.given() - scene.given()), 1e-3 * scene.given());
  EXPECT_GT(scene.given(), 1e-4);
  EXPECT_NEAR(hand.given(), scene.given(), 1e-9 * scene.given());
  EXPECT_NEAR(hand.returned(), scene.returned(), 1e-9 * scene.given());
}

// The hand feels the coupling's stiffness at any scale of the frame, on a body that is much stiffer.
TEST(LoopContact, ACouplingIsOfTheHand) {
  ResponseSampleOptions options;
  options.friction = options.bias = false;
  const Opened ball(ball_content(options));
  for (const auto& [scale, force_scale] : {std::pair{0.5, 40.0}, {1.0, 20.0}, {4.0, 4.0}}) {
    DeviceFrame frame;
    frame.pose.translation = {0, 0, kBallRadius + kTipRadius};
    frame.scale = scale;
    frame.force_scale = force_scale;
    device::CoupledSource coupled(ball.view, 0, frame, device::coupling_in(frame, {150, 0, 8}));
    ContactSource<> rigid(ball.view, 0, frame);
    double soft = 0, stiff = 0, way = 0;
    for (int k = 0; k <= 400; ++k) {
      way = 5e-6 * k / scale;
      soft = coupled.answer(sample_at({0, 0, -way}), 1e-3).force.z;
      stiff = rigid.answer(sample_at({0, 0, -way}), 1e-3).force.z;
    }
    EXPECT_LT(soft, 150 * way);
    EXPECT_GT(soft, 0.5 * 150 * way);
    EXPECT_GT(stiff, 1.5 * soft);
    EXPECT_GT(coupled.tick().depth, 0);
  }
}

// After a force was taken away: what was pressed in meanwhile gives nothing back.
TEST(LoopContact, AResetContactBeginsWithoutForce) {
  const Opened ball(ball_content({}));
  DeviceFrame frame;
  frame.pose.translation = {0, 0, kBallRadius + kTipRadius};
  ContactSource<> source(ball.view, 0, frame);
  device::Answer answer;
  for (int k = 0; k <= 300; ++k) answer = source.answer(sample_at({0, 0, 1e-3 - 1e-5 * k}), 1e-3);
  EXPECT_GT(answer.force.z, 0.1);
  source.reset();
  answer = source.answer(sample_at({0, 0, -0.003}), 1e-3);
  EXPECT_TRUE(answer.usable);
  EXPECT_EQ(length(answer.force), 0);
}

// A hand that pulls the device down into the ball, engaged: the loop's force holds it at a depth, within the limits.
TEST(LoopContact, ASimulatedHandRestsOnTheBall) {
  static FakeClock clock;
  clock = FakeClock();
  const Opened ball(ball_content({}));
  DeviceFrame frame;
  frame.pose.translation = {0, 0, kBallRadius + kTipRadius};
  ContactSource<> source(ball.view, 0, frame);
  const device::SimKind& kind = *device::find_sim_kind("sim");
  device::PlantOptions plant = kind.plant;
  plant.start = {0, 0, 0.004};
  plant.hand.intended = [](double time) {
    return device::Intent{{0, 0, time < 2 ? 0.004 : std::max(-0.006, 0.004 - 0.01 * (time - 2))}, {}};
  };
  device::SimDevice device(kind.kind, plant, {}, [] { return clock.now(); });
  LoopOptions options;
  options.seconds = 6;
  options.safety.rate = 2000;
  device::StopFlags stop;
  device::ForceLoop loop(device, source, options, stop, nullptr, clock);
  loop.run();
  const device::LoopReport& report = loop.report();
  EXPECT_EQ(report.out.cause, Cause::asked);
  EXPECT_EQ(report.suspensions, 0U);
  EXPECT_GT(report.peak_force, 0.3);
  EXPECT_LE(report.peak_force, 3);
}

TEST(LoopContact, ASearchInAnotherThreadGivesForces) {
  const Opened ball(ball_content({}));
  DeviceFrame frame;
  frame.pose.translation = {0, 0, kBallRadius + kTipRadius};
  device::TrackedSource source(ball.view, 0, frame, {1000, 10, {}});
  double largest = 0;
  for (int k = 0; k < 400; ++k) {
    largest = std::max(largest, source.answer(sample_at({0, 0, 0.002 - 1e-5 * k}), 1e-3).force.z);
    std::this_thread::sleep_for(std::chrono::microseconds(300));
  }
  EXPECT_GT(largest, 0.1);
}

TEST(LoopContact, ATrackerThatDiesOrHangsIsNoForceAndThenTheEnd) {
  for (const bool throws : {true, false}) {
    const Opened ball(ball_content({}));
    std::atomic<bool> dies{false}, ends{false};
    std::atomic<int> searches{0};
    DeviceFrame frame;
    frame.pose.translation = {0, 0, kBallRadius + kTipRadius};
    device::TrackerOptions tracker;
    tracker.rate = 5000;
    tracker.stale = 0.1;
    tracker.search = [&](const Pose& pose) {
      if (dies && throws) throw std::runtime_error("lost");
      while (dies && !ends) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ++searches;
      return runtime::search(ball.view, 0, pose);
    };
    device::TrackedSource source(ball.view, 0, frame, tracker);
    FakeClock clock;
    ScriptedDevice device(clock);
    int died = 0, seen = 0;
    device.script = [&](int tick, Sample& sample) {
      sample.pose = upright({0, 0, tick < 200 ? 0.001 : std::max(-0.002, 0.001 - 1e-5 * (tick - 200))});
      // The ticks are fake and the tracker's thread is not: every now and then they wait for it.
      while (tick % 20 == 0 && !dies && searches == seen) std::this_thread::sleep_for(std::chrono::microseconds(100));
      if (tick % 20 == 0) seen = searches;
      if (tick == 1500) dies = true, died = tick;
    };
    LoopOptions options;
    options.seconds = 20;
    device::StopFlags stop;
    device::ForceLoop loop(device, source, options, stop, nullptr, clock);
    loop.run();
    ends = true;
    EXPECT_EQ(loop.report().out.mode, Mode::stopped);
    EXPECT_EQ(loop.report().out.cause, Cause::source);
    ASSERT_GT(died, 0);
    EXPECT_GT(length(device.commands[static_cast<std::size_t>(died) - 1].force), 0.01);
    // Stale after 0.1 s, the search that was under way included; over after half a second more.
    for (std::size_t k = static_cast<std::size_t>(died) + 130; k < device.commands.size(); ++k) {
      ASSERT_EQ(length(device.commands[k].force), 0) << k - static_cast<std::size_t>(died);
    }
    EXPECT_LT(loop.report().ticks, static_cast<std::uint64_t>(died) + 700);
  }
}

}  // namespace
}  // namespace palpate::test
