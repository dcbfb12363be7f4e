// SPDX-License-Identifier: GPL-3.0-or-later
// The Falcon's life from opened to stopped against its model, in virtual time.
#include "device/falcon/falcon_protocol.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/device/models/falcon_model.hpp"
#include "tests/device/models/virtual_link.hpp"
#include "tests/device/seeded.hpp"
#include "tests/support/temporary_folder.hpp"

namespace palpate::device::falcon_protocol_test {
namespace {

using falcon::Boot;
using falcon::Input;
using falcon::kCentre;
using runtime::Vec3;
using test::Bytes;
using test::FalconModel;
using test::VirtualLink;

// Not the maker's: any bytes that the model takes for it. No multiple of a chunk.
Bytes firmware() {
  test::Seeded random(7);
  Bytes bytes(1500);
  for (auto& byte : bytes) byte = random.byte();
  return bytes;
}

constexpr std::array<std::int16_t, 3> kStill{};
bool pushes(const FalconModel& model) { return model.motors() != kStill; }

bool let_go(const VirtualLink& link, const Protocol& protocol) {
  const Request zero = protocol.zero();
  return link.written == Bytes(zero.bytes, zero.bytes + zero.size);
}

// A Falcon whose grip is pushed up by 2 N, ready.
struct Ready {
  FalconModel model{firmware()};
  FalconProtocol protocol{firmware()};
  VirtualLink link{protocol, model};

  Ready() {
    model.leave_running({});
    model.homed = Input::kHomed;
    link.command.force = {0, 2, 0};
    EXPECT_TRUE(link.run_until(Phase::ready, 1));
    link.run(0.05);
    EXPECT_TRUE(pushes(model));
  }

  // From now on: no force within 10 ms, then this fault, and zero is all that is still sent.
  void expect_end(Fault fault, double within = 0.15) {
    const double began = link.time;
    EXPECT_TRUE(link.run(0.010, [&] { return let_go(link, protocol); })) << "a force after 10 ms";
    EXPECT_TRUE(link.run_until(Phase::stopped, within));
    EXPECT_EQ(protocol.sample().fault, fault) << name(protocol.sample().fault);
    EXPECT_LE(link.time - began, within);
    link.run(0.02, [&] {
      EXPECT_TRUE(let_go(link, protocol));
      return false;
    });
    EXPECT_EQ(protocol.sample().phase, Phase::stopped);
  }
};

TEST(FalconLife, BootsHomesAndPushes) {
  FalconModel model(firmware());
  FalconProtocol protocol(firmware());
  VirtualLink link(protocol, model);
  link.command.force = {1, 2, -0.5};
  ASSERT_TRUE(link.run_until(Phase::homing, 10));
  EXPECT_TRUE(model.running());
  EXPECT_EQ(model.loads(), 1);

  // The user pulls it out and pushes it in: arm after arm finds its origin. No position, and no force before the last.
  for (const int bits : {0x00, 0x10, 0x50}) {
    model.homed = static_cast<std::uint8_t>(bits);
    link.run(0.05, [&] {
      EXPECT_FALSE(pushes(model));
      return false;
    });
    EXPECT_EQ(protocol.sample().phase, Phase::homing);
    EXPECT_EQ(length(protocol.sample().pose.translation), 0);
  }
  EXPECT_NE(model.lights() & falcon::Output::kRed, 0);
  EXPECT_NE(model.lights() & falcon::Output::kHoming, 0);
  model.tip = kCentre + Vec3{0.01, -0.02, 0.005};
  model.homed = Input::kHomed;
  ASSERT_TRUE(link.run_until(Phase::ready, 0.1));
  model.buttons = Input::kCentre;
  link.run(0.02);
  EXPECT_NE(model.lights() & falcon::Output::kBlue, 0);
  EXPECT_EQ(protocol.sample().buttons, Input::kCentre);
  EXPECT_EQ(protocol.sample().fault, Fault::none);
  // Within what a count of the encoders is at the grip.
  EXPECT_LT(length(protocol.sample().pose.translation - Vec3{0.01, -0.02, 0.005}), 1e-4);
  const auto expected = falcon::motors(falcon::torques(falcon::inverse(model.tip), link.command.force));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(model.motors()[i], expected[i], 4);

  // It follows the hand.
  for (int i = 0; i < 400; ++i) {
    const double turn = 0.03 * i;
    model.tip = kCentre + Vec3{0.01 + 0.02 * std::sin(turn), -0.02 * std::cos(turn), 0.005 * std::cos(2 * turn)};
    link.run(0.001);
  }
  link.run(0.005);
  EXPECT_LT(length(protocol.sample().pose.translation - (model.tip - kCentre)), 1e-4);
  EXPECT_GT(protocol.sample().number, 200U);
  EXPECT_LT(link.time - protocol.sample().time, 0.003);
}

TEST(FalconLife, FirmwareThatRunsIsLeftRunningAndItsForceReleased) {
  FalconModel model(firmware());
  FalconProtocol protocol;  // no file needed
  VirtualLink link(protocol, model);
  model.leave_running({900, 900, 900});  // of a program that died
  ASSERT_TRUE(link.run_until(Phase::homing, 0.1));
  EXPECT_EQ(model.loads(), 0);
  EXPECT_FALSE(pushes(model));
}

TEST(FalconLife, RateIsThatOfTheLoop) {
  Ready falcon;
  for (const double period : {0.001, 0.00025}) {
    falcon.link.period = period;
    const int before = falcon.link.writes;
    const std::uint32_t samples = falcon.protocol.sample().number;
    falcon.link.run(1.0);
    EXPECT_NEAR(falcon.link.writes - before, 1 / period, 5);
    EXPECT_NEAR(falcon.protocol.sample().number - samples, 1 / period, 20);
  }
}

TEST(FalconBoot, LoadsAgainWhenAnEchoIsWrong) {
  FalconModel model(firmware());
  model.faults.bad_echoes = 3;
  model.faults.deaf_greetings = 7;
  model.faults.leading_zero = true;
  FalconProtocol protocol(firmware());
  VirtualLink link(protocol, model);
  ASSERT_TRUE(link.run_until(Phase::homing, 20));
  EXPECT_EQ(model.loads(), 4);
}

struct BootFailure {
  const char* what;
  Bytes given;
  std::function<void(FalconModel&)> set;
  Fault fault;
  int loads;
};

TEST(FalconBoot, EndsWithANamedCause) {
  Bytes wrong = firmware();
  wrong[700] ^= 1;
  const auto nothing = [](FalconModel&) {};
  const BootFailure failures[] = {
      {"no firmware named", {}, nothing, Fault::firmware, 0},
      {"another firmware", wrong, nothing, Fault::firmware, Boot::kAttempts},
      {"echoes always wrong", firmware(), [](FalconModel& m) { m.faults.bad_echoes = 99; }, Fault::firmware,
       Boot::kAttempts},
      {"nothing answers", firmware(), [](FalconModel& m) { m.faults.mute = true; }, Fault::silent, 0},
      {"greeted a hundred times", firmware(), [](FalconModel& m) { m.faults.deaf_greetings = 100; }, Fault::silent, 0},
      {"the loader mumbles", firmware(), [](FalconModel& m) { m.faults.drop_every = 4; }, Fault::garbled, 0},
      {"the chip refuses", firmware(), [](FalconModel& m) { m.faults.refuse_control = true; }, Fault::stalled, 0},
  };
  for (const BootFailure& failure : failures) {
    SCOPED_TRACE(failure.what);
    FalconModel model(firmware());
    failure.set(model);
    FalconProtocol protocol(failure.given);
    VirtualLink link(protocol, model);
    EXPECT_TRUE(link.run_until(Phase::stopped, 30));
    EXPECT_EQ(protocol.sample().fault, failure.fault) << name(protocol.sample().fault);
    EXPECT_EQ(model.loads(), failure.loads);
    link.run(0.002);
    EXPECT_TRUE(let_go(link, protocol));
  }
}

TEST(FalconBoot, TheHundredthGreetingIsHeard) {
  FalconModel model(firmware());
  model.faults.deaf_greetings = Boot::kGreetings - 1;
  FalconProtocol protocol(firmware());
  VirtualLink link(protocol, model);
  EXPECT_TRUE(link.run_until(Phase::homing, 20));
}

TEST(FalconBoot, AnswersMayOvertakeTheNewsThatAWriteHasLeft) {
  FalconProtocol protocol(firmware());
  FalconModel model(firmware());
  model.plugged(0);
  protocol.start(0);
  double time = 0;
  for (int i = 0; i < 200000 && protocol.sample().phase == Phase::starting; ++i, time += 0.0005) {
    const Request request = protocol.next(time, {});
    Bytes none;
    if (request.kind == Request::Kind::control) {
      model.control(time, {request.request_type, request.request, request.value, request.index, {}}, none);
    } else if (request.kind == Request::Kind::write) {
      model.written(time, {request.bytes, request.bytes + request.size});
      time += 0.02;
    }
    Bytes packet;
    while (model.read(time, packet)) protocol.received(time, packet.data(), packet.size());
    if (request.kind != Request::Kind::none) protocol.ended(time, Outcome::done);
  }
  EXPECT_EQ(protocol.sample().phase, Phase::homing) << name(protocol.sample().fault);
  EXPECT_EQ(model.loads(), 1);
}

TEST(FalconFirmware, FilesAreReadOrRefusedByName) {
  const test::TemporaryFolder folder;
  const std::string path = folder.path() / "any.bin";
  const auto put = [&](std::size_t size) { folder.write("any.bin", std::string(size, 'x')); };
  put(1000);
  EXPECT_EQ(falcon::read_firmware(path).bytes.size(), 1000U);
  EXPECT_EQ(falcon::read_firmware(path).error, "");
  put(falcon::kMostFirmware);
  EXPECT_EQ(falcon::read_firmware(path).error, "");
  put(falcon::kMostFirmware + 1);
  EXPECT_NE(falcon::read_firmware(path).error.find("longer than"), std::string::npos);
  put(0);
  EXPECT_EQ(falcon::read_firmware(path).error, path + ": is empty");
  EXPECT_EQ(falcon::read_firmware(folder.path() / "none").error,
            (folder.path() / "none").string() + ": cannot be opened");
  EXPECT_NE(falcon::read_firmware(folder.path()).error, "");
  EXPECT_TRUE(falcon::read_firmware(folder.path()).bytes.empty());
}

TEST(FalconFault, Silence) {
  Ready falcon;
  falcon.model.faults.mute = true;
  falcon.expect_end(Fault::silent);
}

TEST(FalconFault, Garble) {
  Ready falcon;
  falcon.model.faults.flip = 0x08;
  falcon.expect_end(Fault::garbled);
}

TEST(FalconFault, LostBytesInEveryPacket) {
  Ready falcon;
  falcon.model.faults.drop_every = 11;
  falcon.expect_end(Fault::garbled);
}

TEST(FalconFault, ShortPackets) {
  Ready falcon;
  falcon.link.chop = 3;
  falcon.expect_end(Fault::garbled);
}

TEST(FalconFault, WrappedEncoder) {
  Ready falcon;
  falcon.model.faults.shift[1] = 32768;
  falcon.expect_end(Fault::impossible);
}

TEST(FalconFault, LeapOfTwentyDegrees) {
  Ready falcon;
  falcon.model.faults.shift[2] = 549;
  falcon.expect_end(Fault::impossible);
}

TEST(FalconFault, APlaceThatTheArmsReachAndNoGripDoes) {
  FalconModel model(firmware());
  FalconProtocol protocol;
  VirtualLink link(protocol, model);
  model.leave_running({});
  model.homed = Input::kHomed;
  model.tip = {0.06, 0.05, 0.08};
  ASSERT_TRUE(falcon::inverse(model.tip).reached);
  EXPECT_TRUE(link.run_until(Phase::stopped, 0.2));
  EXPECT_EQ(protocol.sample().fault, Fault::impossible);
}

TEST(FalconFault, LostOrigin) {
  Ready falcon;
  falcon.model.faults.lose_home = true;
  falcon.expect_end(Fault::reported);
}

TEST(FalconFault, Stall) {
  Ready falcon;
  falcon.link.outcome = Outcome::stalled;
  falcon.expect_end(Fault::stalled);
}

TEST(FalconFault, NothingIsTakenAnyMore) {
  Ready falcon;
  falcon.link.outcome = Outcome::timed_out;
  falcon.expect_end(Fault::stalled);
}

TEST(FalconFault, Unplugged) {
  Ready falcon;
  falcon.link.outcome = Outcome::gone;
  falcon.expect_end(Fault::unplugged);
}

TEST(FalconFault, PlacesThatNoGripCanBeWhileHoming) {
  // Out of reach; folded through itself; one turn too many.
  for (const std::array<int, 3> shift : {std::array{-6000, 3000, 0}, {5000, -5000, 5000}, {9880, 9880, 9880}}) {
    FalconModel model(firmware());
    FalconProtocol protocol;
    VirtualLink link(protocol, model);
    model.leave_running({});
    model.homed = Input::kHomed;
    model.faults.shift = shift;
    EXPECT_TRUE(link.run_until(Phase::stopped, 0.2));
    EXPECT_EQ(protocol.sample().fault, Fault::impossible);
  }
}

// Harmless: packets split over transfers, one lost byte in a while, a pause of the host or of the device.
TEST(FalconFault, WhatPassesIsNoFault) {
  Ready falcon;
  falcon.model.faults.most = 5;
  falcon.link.run(0.2);
  EXPECT_EQ(falcon.protocol.sample().phase, Phase::ready);
  falcon.model.faults.most = 62;
  falcon.model.faults.drop_every = 16 * 50 + 1;
  falcon.link.run(2);
  EXPECT_EQ(falcon.protocol.sample().phase, Phase::ready) << name(falcon.protocol.sample().fault);
  falcon.model.faults.drop_every = 0;

  // The device pauses: no force from 6 ms on, and again once it answers.
  falcon.model.faults.mute = true;
  EXPECT_TRUE(falcon.link.run(0.010, [&] { return !pushes(falcon.model); }));
  falcon.link.run(0.04);
  falcon.model.faults.mute = false;
  EXPECT_TRUE(falcon.link.run(0.005, [&] { return pushes(falcon.model); }));

  // The host sleeps for a second: that is not the device's silence, but its place is no longer known.
  falcon.link.run(0.01);
  falcon.link.time += 1.0;
  const int before = falcon.link.writes;
  falcon.link.run(0.05, [&] { return falcon.link.writes > before + 5; });
  EXPECT_EQ(falcon.protocol.sample().phase, Phase::ready) << name(falcon.protocol.sample().fault);
  EXPECT_TRUE(falcon.link.run(0.005, [&] { return pushes(falcon.model); }));
}

// Bytes that come late: nothing is pushed on what is old, and what follows is silence or goes on.
TEST(FalconFault, LatePackets) {
  Ready falcon;
  falcon.model.faults.late = 0.030;
  EXPECT_TRUE(falcon.link.run(0.010, [&] { return !pushes(falcon.model); }));
  falcon.model.faults.late = 0;
  falcon.link.run(0.1);
  EXPECT_EQ(falcon.protocol.sample().phase, Phase::ready);
  falcon.model.faults.late = 0.200;
  falcon.expect_end(Fault::silent);
}

TEST(FalconFault, AForceThatIsNoNumberIsNone) {
  Ready falcon;
  falcon.link.command.force = {std::nan(""), 0, 0};
  falcon.link.run(0.003);
  EXPECT_FALSE(pushes(falcon.model));
  falcon.link.command.force = {1e300, 1e300, -1e300};
  falcon.link.run(0.003);
  for (const int count : falcon.model.motors()) EXPECT_LE(std::abs(count), falcon::kMostCounts);
}

}  // namespace
}  // namespace palpate::device::falcon_protocol_test
