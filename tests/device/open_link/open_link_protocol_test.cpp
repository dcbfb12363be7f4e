// SPDX-License-Identifier: GPL-3.0-or-later
// The open link's host against the very core of its firmware, in virtual time.
#include "device/open_link/open_link_protocol.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/device/models/open_link_model.hpp"
#include "tests/device/models/virtual_link.hpp"

namespace palpate::device::open_link_protocol_test {
namespace {

using namespace openlink;
using test::Bytes;
using test::OpenLinkModel;
using test::VirtualLink;

constexpr std::array<float, 3> kNone{};

// The newest frame written lets go.
bool lets_go(const VirtualLink& link) {
  Frame frame;
  std::copy(link.written.begin(), link.written.end(), frame.bytes);
  Drive drive;
  return decode(frame, drive) && !drive.on;
}

// A device pushed along x and turned about x, ready.
struct Ready {
  OpenLinkModel model;
  OpenLinkProtocol protocol;
  VirtualLink link{protocol, model};

  Ready() {
    link.command.force = {2, -1, 0};
    link.command.torque = {0.1, 0, 0};
    EXPECT_TRUE(link.run_until(Phase::ready, 0.2));
    link.run(0.05);
    EXPECT_NE(model.force, kNone);
  }

  // From now on: a command to let go within 10 ms, then this fault, and no other message.
  void expect_end(Fault fault, double within = 0.15) {
    EXPECT_TRUE(link.run(0.010, [&] { return lets_go(link); })) << "a force after 10 ms";
    EXPECT_TRUE(link.run_until(Phase::stopped, within));
    EXPECT_EQ(protocol.sample().fault, fault) << name(protocol.sample().fault);
    link.run(0.02, [&] {
      EXPECT_TRUE(lets_go(link));
      return false;
    });
    EXPECT_EQ(protocol.sample().phase, Phase::stopped);
    if (link.outcome == Outcome::done && !model.faults.frozen) {
      EXPECT_EQ(model.force, kNone);
    }
  }
};

TEST(OpenLinkLife, MeetsHomesAndPushes) {
  OpenLinkModel model;
  model.measured.homed = false;
  OpenLinkProtocol protocol;
  VirtualLink link(protocol, model);
  link.command.force = {2, -1, 0.5};
  link.command.torque = {0.05, 0.1, 0.1};
  ASSERT_TRUE(link.run_until(Phase::homing, 0.1));
  EXPECT_STREQ(protocol.capabilities().name, "modelled handle");
  EXPECT_EQ(protocol.capabilities().peak_force, 6);
  link.run(0.2, [&] {
    EXPECT_EQ(model.force, kNone);
    return false;
  });
  EXPECT_EQ(protocol.sample().phase, Phase::homing);
  EXPECT_EQ(length(protocol.sample().pose.translation), 0);

  model.measured.homed = true;
  model.measured.position[0] = 0.03F;
  model.measured.buttons = 2;
  ASSERT_TRUE(link.run_until(Phase::ready, 0.05));
  link.run(0.02);
  EXPECT_EQ(model.force, (std::array<float, 3>{2, -1, 0.5F}));
  EXPECT_EQ(model.torque, (std::array<float, 3>{0.05F, 0, 0}));  // it drives no other
  EXPECT_EQ(protocol.sample().buttons, 2U);
  EXPECT_NEAR(protocol.sample().pose.translation.x, 0.03, 1e-8);

  for (int i = 0; i <= 300; ++i) {
    const double turn = 0.005 * i;
    model.measured.position[1] = static_cast<float>(0.02 * std::sin(turn));
    model.measured.orientation[0] = static_cast<float>(std::cos(turn / 2));
    model.measured.orientation[3] = static_cast<float>(std::sin(turn / 2));
    link.run(0.001);
  }
  link.run(0.005);
  const Sample& sample = protocol.sample();
  EXPECT_EQ(sample.phase, Phase::ready) << name(sample.fault);
  EXPECT_NEAR(sample.pose.translation.y, 0.02 * std::sin(1.5), 1e-8);
  EXPECT_NEAR(sample.pose.rotation[0], std::cos(1.5), 1e-6);
  EXPECT_NEAR(sample.pose.rotation[3], std::sin(1.5), 1e-6);
  EXPECT_LT(link.time - sample.time, 0.002);
}

TEST(OpenLinkLife, LimitsAreThoseOfTheDeviceAndKeepTheDirection) {
  Ready device;
  device.link.command.force = {300, -400, 0};
  device.link.command.torque = {-9, 0, 0};
  device.link.run(0.005);
  EXPECT_NEAR(device.model.force[0], 3.6, 1e-5);
  EXPECT_NEAR(device.model.force[1], -4.8, 1e-5);
  EXPECT_NEAR(device.model.torque[0], -0.2, 1e-6);
  device.link.command.force = {std::nan(""), 1, 1};
  device.link.run(0.005);
  EXPECT_EQ(device.model.force, kNone);
}

TEST(OpenLinkLife, RateStaysWithinWhatTheDeviceTakes) {
  Capabilities slow = OpenLinkModel::usual();
  slow.rate = 500;
  OpenLinkModel model(slow);
  OpenLinkProtocol protocol;
  VirtualLink link(protocol, model);
  ASSERT_TRUE(link.run_until(Phase::ready, 1));
  const int before = link.writes;
  link.period = 0.00025;
  link.run(1);
  EXPECT_GT(link.writes - before, 450);
  EXPECT_LT(link.writes - before, 560);
}

TEST(OpenLinkLife, HostsBeginAnew) {
  Ready device;
  // Another program takes over, with sequences of its own, while the device still drives.
  OpenLinkProtocol second;
  second.start(device.link.time);
  device.model.written(device.link.time, [&] {
    const Request hello = second.next(device.link.time, {});
    return Bytes(hello.bytes, hello.bytes + hello.size);
  }());
  Bytes packet;
  EXPECT_TRUE(device.model.read(device.link.time + 0.001, packet));
  EXPECT_EQ(device.model.force, kNone);
  second.received(device.link.time + 0.001, packet.data(), packet.size());
  EXPECT_EQ(second.sample().phase, Phase::homing);
}

struct Introduction {
  const char* what;
  std::function<void(Capabilities&)> set;
  std::function<void(OpenLinkModel&)> spoil;
  Fault fault;  // none: it gets ready
};

TEST(OpenLinkMeeting, EndsWithANamedCause) {
  const auto usual = [](Capabilities&) {};
  const auto well = [](OpenLinkModel&) {};
  const Introduction introductions[] = {
      {"a newer minor version", [](Capabilities& c) { c.minor = 7; }, well, Fault::none},
      {"another major version", [](Capabilities& c) { c.major = 2; }, well, Fault::firmware},
      {"limits that cannot be", [](Capabilities& c) { c.watchdog = 5; }, well, Fault::impossible},
      {"nobody there", usual, [](OpenLinkModel& m) { m.faults.mute = true; }, Fault::silent},
      {"somebody else there", usual, [](OpenLinkModel& m) { m.faults.flip = 1; }, Fault::garbled},
      {"a place out of its radius", usual, [](OpenLinkModel& m) { m.measured.position[0] = 0.2F; }, Fault::impossible},
  };
  for (const Introduction& each : introductions) {
    SCOPED_TRACE(each.what);
    Capabilities capabilities = OpenLinkModel::usual();
    each.set(capabilities);
    OpenLinkModel model(capabilities);
    each.spoil(model);
    OpenLinkProtocol protocol;
    VirtualLink link(protocol, model);
    link.command.force = {1, 0, 0};
    EXPECT_TRUE(link.run_until(each.fault == Fault::none ? Phase::ready : Phase::stopped, 3));
    EXPECT_EQ(protocol.sample().fault, each.fault) << name(protocol.sample().fault);
    if (each.fault != Fault::none) {
      EXPECT_EQ(model.force, kNone);
    }
  }
}

struct Trouble {
  const char* what;
  std::function<void(Ready&)> begin;
  Fault fault;
};

TEST(OpenLinkFault, EachEndsInZeroAndAName) {
  const Trouble troubles[] = {
      {"silence", [](Ready& r) { r.model.faults.mute = true; }, Fault::silent},
      {"frozen", [](Ready& r) { r.model.faults.frozen = true; }, Fault::silent},
      {"late", [](Ready& r) { r.model.faults.late = 0.03; }, Fault::silent},
      {"garbled", [](Ready& r) { r.model.faults.flip = 0x40; }, Fault::garbled},
      {"bytes lost in every frame", [](Ready& r) { r.model.faults.drop_every = 20; }, Fault::garbled},
      {"short packets", [](Ready& r) { r.link.chop = 4; }, Fault::garbled},
      {"leap", [](Ready& r) { r.model.measured.position[1] = 0.09F; }, Fault::impossible},
      {"out of reach", [](Ready& r) { r.model.measured.position[1] = 0.2F; }, Fault::impossible},
      {"no number", [](Ready& r) { r.model.measured.position[1] = std::nanf(""); }, Fault::impossible},
      {"no rotation", [](Ready& r) { r.model.measured.orientation[0] = 0; }, Fault::impossible},
      {"turned over",
       [](Ready& r) {
         r.model.measured.orientation[0] = 0;
         r.model.measured.orientation[1] = 1;
       },
       Fault::impossible},
      {"clock stands", [](Ready& r) { r.model.clock_rate = 0; }, Fault::impossible},
      {"clock runs ahead", [](Ready& r) { r.model.clock_rate = 100; }, Fault::impossible},
      {"origin lost", [](Ready& r) { r.model.measured.homed = false; }, Fault::reported},
      {"too hot", [](Ready& r) { r.model.measured.fault = 3; }, Fault::reported},
      {"stall", [](Ready& r) { r.link.outcome = Outcome::stalled; }, Fault::stalled},
      {"nothing taken", [](Ready& r) { r.link.outcome = Outcome::timed_out; }, Fault::stalled},
      {"unplugged", [](Ready& r) { r.link.outcome = Outcome::gone; }, Fault::unplugged},
  };
  for (const Trouble& trouble : troubles) {
    SCOPED_TRACE(trouble.what);
    Ready device;
    trouble.begin(device);
    device.expect_end(trouble.fault);
  }
}

TEST(OpenLinkFault, WhatPassesIsNoFault) {
  Ready device;
  const auto pushes = [&] { return device.model.force != kNone; };
  device.model.faults.most = 7;
  device.link.run(0.2);
  EXPECT_TRUE(pushes());
  device.model.faults.drop_every = 46 * 30 + 1;
  device.link.run(3);
  EXPECT_EQ(device.protocol.sample().phase, Phase::ready) << name(device.protocol.sample().fault);
  device.model.faults.drop_every = 0;
  device.link.run(0.1);
  // A pause in what comes back: no force on what is old, and again when it is fresh.
  device.model.faults.late = 0.03;
  EXPECT_TRUE(device.link.run(0.010, [&] { return !pushes(); }));
  device.link.run(0.02);
  device.model.faults.late = 0;
  device.link.run(0.05);
  EXPECT_TRUE(pushes());
}

TEST(OpenLinkFault, FramesThatComeTwiceAreNoNews) {
  Ready device;
  OpenLinkProtocol& protocol = device.protocol;
  const auto heard = [&](std::uint8_t sequence, std::uint32_t clock) {
    State state;
    state.flags = State::kHomed;
    state.clock = clock;
    const Frame frame = encode(sequence, state);
    protocol.received(device.link.time, frame.bytes, frame.size());
    return protocol.sample().number;
  };
  // A device that has just begun: its first frame, then later ones, then old ones.
  protocol.start(device.link.time);
  const Frame hello = encode(0, OpenLinkModel::usual());
  protocol.received(device.link.time, hello.bytes, hello.size());
  EXPECT_EQ(heard(1, 1000), 1U);
  EXPECT_EQ(heard(1, 1500), 1U);
  EXPECT_EQ(heard(3, 2000), 2U);
  EXPECT_EQ(heard(2, 2500), 2U);
  EXPECT_EQ(heard(250, 2500), 2U);
  EXPECT_EQ(heard(4, 2500), 3U);
  EXPECT_EQ(protocol.sample().fault, Fault::none);
}

// A host that was held up while homing reads what has waited, then what is fresh: between the two the device's clock
// has gone further than the host's.
TEST(OpenLinkFault, AHostThatWasHeldUpIsNoFaultOfTheDevice) {
  OpenLinkModel model;
  model.measured.homed = false;
  OpenLinkProtocol protocol;
  VirtualLink link(protocol, model);
  ASSERT_TRUE(link.run_until(Phase::homing, 0.1));
  link.run(0.05);
  model.advance(link.time + 0.001);
  link.time += 0.5;
  link.run(0.05);
  EXPECT_EQ(protocol.sample().phase, Phase::homing) << name(protocol.sample().fault);
}

// The host sleeps with a force given. The device lets go by itself, and the host that wakes up says why it stops.
TEST(OpenLinkWatchdog, LetsGoWhenTheHostSleeps) {
  Ready device;
  const double asleep = device.link.time;
  device.model.advance(asleep + 0.019);
  EXPECT_NE(device.model.force, kNone);
  device.model.advance(asleep + 0.0215);
  EXPECT_EQ(device.model.force, kNone);
  device.link.time = asleep + 0.5;
  device.link.run(0.01);
  EXPECT_EQ(device.protocol.sample().phase, Phase::stopped);
  EXPECT_EQ(device.protocol.sample().fault, Fault::host_late);
  EXPECT_EQ(device.model.force, kNone);
}

// The firmware alone, frame by frame.
struct Bench {
  OpenLinkModel model;
  double time = 0;
  std::uint8_t sequence = 0;

  Bench() {
    model.plugged(0);
    send(encode(sequence, Hello{}));
  }
  void send(const Frame& frame) {
    model.written(time, {frame.bytes, frame.bytes + frame.size()});
    time += 0.001;
  }
  void push(float force) { push_as(++sequence, force); }
  void push_as(std::uint8_t number, float force) {
    Drive drive;
    drive.on = true;
    drive.force[0] = force;
    send(encode(number, drive));
  }
  void let_go() { send(encode(++sequence, Drive{})); }

  // All that it has answered since.
  std::vector<Frame> answers() {
    Reader reader;
    std::vector<Frame> frames;
    for (Bytes packet; model.read(time, packet);) {
      for (const std::uint8_t byte : packet) {
        reader.put(byte);
        for (Frame frame; reader.get(frame);) frames.push_back(frame);
      }
    }
    return frames;
  }
  State state() {
    State state;
    const auto frames = answers();
    EXPECT_FALSE(frames.empty());
    if (!frames.empty()) {
      EXPECT_TRUE(decode(frames.back(), state));
    }
    return state;
  }
};

TEST(OpenLinkFirmware, AnswersHelloAndEveryDriveOnce) {
  Bench bench;
  auto answers = bench.answers();
  ASSERT_EQ(answers.size(), 1U);
  Capabilities told;
  EXPECT_TRUE(decode(answers[0], told));
  EXPECT_EQ(wrong(told), nullptr);
  for (int i = 0; i < 5; ++i) bench.push(1);
  answers = bench.answers();
  ASSERT_EQ(answers.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    State state;
    ASSERT_TRUE(decode(answers[i], state));
    EXPECT_EQ(answers[i].sequence(), i + 1);
    EXPECT_EQ(state.heard, i + 1);
    EXPECT_EQ(state.flags, State::kHomed | State::kDriving);
  }
}

TEST(OpenLinkFirmware, WhatIsLateOrComesTwiceDoesNothingButLetGo) {
  Bench bench;
  bench.push(1);
  EXPECT_EQ(bench.state().heard, 1);
  bench.push_as(1, 2);
  bench.push_as(0, 2);
  bench.push_as(200, 2);
  EXPECT_TRUE(bench.answers().empty());
  EXPECT_EQ(bench.model.force[0], 1);
  bench.push_as(128, 3);
  bench.answers();
  EXPECT_EQ(bench.model.force[0], 3);
  bench.send(encode(5, Drive{}));  // old, and lets go
  EXPECT_EQ(bench.state().heard, 128);
  EXPECT_EQ(bench.model.force, kNone);
}

TEST(OpenLinkFirmware, TripsAndStaysSoUntilHello) {
  Bench bench;
  bench.push(1);
  bench.time += 0.1;
  bench.answers();
  EXPECT_EQ(bench.model.force, kNone);
  bench.push(1);
  EXPECT_EQ(bench.state().flags, State::kHomed | State::kTripped);
  EXPECT_EQ(bench.model.force, kNone);
  bench.let_go();
  EXPECT_EQ(bench.state().flags, State::kHomed | State::kTripped);
  bench.push(1);
  EXPECT_EQ(bench.state().flags, State::kHomed | State::kTripped);
  bench.send(encode(++bench.sequence, Hello{}));
  bench.push(1);
  EXPECT_EQ(bench.state().flags, State::kHomed | State::kDriving);
  EXPECT_EQ(bench.model.force[0], 1);
  // Nothing driven, nothing to trip.
  bench.let_go();
  bench.time += 0.1;
  bench.push(1);
  EXPECT_EQ(bench.state().flags, State::kHomed | State::kDriving);
}

TEST(OpenLinkFirmware, DrivesNothingThatItMustNot) {
  Bench bench;
  bench.push(1);
  bench.model.measured.homed = false;
  bench.push(1);
  EXPECT_EQ(bench.state().flags, 0);
  EXPECT_EQ(bench.model.force, kNone);
  bench.model.measured.homed = true;
  bench.push(1);
  bench.answers();
  EXPECT_EQ(bench.model.force[0], 1);
  bench.model.measured.fault = 9;
  bench.time += 0.001;
  bench.answers();
  EXPECT_EQ(bench.model.force, kNone);
  bench.push(1);
  EXPECT_EQ(bench.state().fault, 9);
  EXPECT_EQ(bench.model.force, kNone);
  bench.model.measured.fault = 0;
  for (const float bad : {std::nanf(""), INFINITY, -INFINITY}) {
    bench.push(1);
    bench.answers();
    EXPECT_EQ(bench.model.force[0], 1);
    bench.push(bad);
    EXPECT_EQ(bench.state().flags, State::kHomed);
    EXPECT_EQ(bench.model.force, kNone);
  }
}

TEST(OpenLinkFirmware, ShortensAlongTheLineWhateverTheSize) {
  Bench bench;
  for (const float size : {1e-30F, 1.0F, 2.0F, 100.0F, 1e20F, 1e38F}) {
    Drive drive;
    drive.on = true;
    drive.force[0] = 3 * size;
    drive.force[1] = -2 * size;
    drive.force[2] = size;
    drive.torque[0] = 1e38F;
    drive.torque[1] = 1e38F;  // not driven: left out before the length is taken
    bench.send(encode(++bench.sequence, drive));
    bench.answers();
    const auto& f = bench.model.force;
    const double longest = std::sqrt(14.0) * size, scale = longest > 6 ? 6 / longest : 1;
    EXPECT_NEAR(f[0], 3 * size * scale, 1e-5 * size * scale);
    EXPECT_NEAR(f[1], -2 * size * scale, 1e-5 * size * scale);
    EXPECT_NEAR(f[2], size * scale, 1e-5 * size * scale);
    EXPECT_LE(std::hypot(f[0], f[1], f[2]), 6.00001);
    EXPECT_EQ(bench.model.torque, (std::array<float, 3>{0.2F, 0, 0}));
  }
}

TEST(OpenLinkFirmware, HostsOfAnotherMajorVersionAreMetAndNotObeyed) {
  Bench bench;
  bench.push(1);
  bench.answers();
  EXPECT_EQ(bench.model.force[0], 1);
  Hello other;
  other.major = 2;
  bench.send(encode(40, other));
  bench.push_as(41, 1);
  const auto answers = bench.answers();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].type(), kCapabilities);
  EXPECT_EQ(bench.model.force, kNone);
}

TEST(OpenLinkFirmware, NothingIsDrivenBeforeHello) {
  OpenLinkModel model;
  model.plugged(0);
  Drive drive;
  drive.on = true;
  drive.force[0] = 1;
  const Frame frame = encode(1, drive);
  model.written(0, {frame.bytes, frame.bytes + frame.size()});
  Bytes packet;
  EXPECT_FALSE(model.read(0.01, packet));
  EXPECT_EQ(model.force, kNone);
}

}  // namespace
}  // namespace palpate::device::open_link_protocol_test
