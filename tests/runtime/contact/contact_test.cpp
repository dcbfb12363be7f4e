// SPDX-License-Identifier: GPL-3.0-or-later
// A ball tip on a box and a ball: press, release, late detection, jumps, rest, promises of the force loop.
#include "palpate/contact/contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <type_traits>

#include "palpate/format/checksum.hpp"
#include "tests/runtime/allocation_counter.hpp"
#include "tests/runtime/support.hpp"

namespace palpate::contact_test {
namespace {

using namespace test;
using runtime::Contact;

TEST(Contact, PressAndLiftFollowTheResponse) {
  for (const bool friction : {true, false}) {
    const Opened box(box_content(flat(friction)));
    Contact contact(box.view, 0);
    const Vec3 side = {0.002, -0.001, 0};
    const auto check = [&](const Pose& pose, const Tick& tick) {
      const double depth = kTop + kTipRadius - pose.translation.z;
      if (depth <= 1e-9) {
        EXPECT_EQ(length(tick.force), 0);
        EXPECT_TRUE(tick.state == State::free || tick.state == State::released);
        return;
      }
      EXPECT_EQ(tick.state, friction ? State::stick : State::slide);
      EXPECT_NEAR(tick.depth, depth, 1e-8);
      EXPECT_EQ(tick.counted_depth, tick.depth);
      EXPECT_LT(distance(tick.force, {0, 0, hertz(depth)}), 1e-4);
      EXPECT_LT(distance(tick.body_point, Vec3{side.x, side.y, kTop}), 1e-8);
      EXPECT_LT(distance(tick.normal, {0, 0, 1}), 1e-9);
    };
    move(contact, centre(-0.01) + side, centre(0.005) + side, 2e-5, check);
    move(contact, centre(0.005) + side, centre(-0.01) + side, 2e-5, check);
  }
}

TEST(Contact, EndsWithOneReleasedTickAndNoForce) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  move(contact, centre(-0.001), centre(0.002));
  int released = 0;
  double last = 1;
  move(contact, centre(0.002), centre(-0.001), 1e-6, [&](const Pose&, const Tick& tick) {
    released += tick.state == State::released;
    EXPECT_LE(length(tick.force), last + 1e-12);
    if (tick.state == State::released) {
      EXPECT_LT(last, 2e-4);
    }
    last = length(tick.force);
  });
  EXPECT_EQ(released, 1);
  EXPECT_EQ(last, 0);
}

TEST(Contact, ToolThatBeginsInsideBeginsWithoutForce) {
  for (const bool friction : {true, false}) {
    const Opened box(box_content(flat(friction)));
    Contact contact(box.view, 0);
    const Tick first = contact.tick(upright(centre(0.003)));
    EXPECT_TRUE(first.touches());
    EXPECT_EQ(length(first.force), 0);
    EXPECT_EQ(first.counted_depth, 0);
    const Tick deeper = move(contact, centre(0.003), centre(0.004));
    EXPECT_NEAR(deeper.depth, 0.004, 1e-8);
    EXPECT_NEAR(deeper.counted_depth, 0.001, 2e-5);
    EXPECT_NEAR(length(deeper.force), hertz(deeper.counted_depth), 1e-3);
  }
}

TEST(Contact, RepeatedPosesInsideKeepTheContact) {
  for (const bool friction : {true, false}) {
    const Opened box(box_content(flat(friction)));
    Contact contact(box.view, 0);
    const auto wait = [&](double depth) {
      Tick tick;
      for (int i = 0; i < 10; ++i) {
        tick = contact.tick(upright(centre(depth)));
        EXPECT_TRUE(tick.touches()) << depth << " " << i;
      }
      return tick;
    };
    double depth = 0.001;
    EXPECT_EQ(length(wait(depth).force), 0);
    Tick tick;
    for (int step = 0; step < 30; ++step) tick = wait(depth += 2e-5);
    EXPECT_NEAR(tick.counted_depth, 6e-4, 2e-5);
    EXPECT_GT(tick.force.z, 0);
  }
}

TEST(Contact, MissingOrthogonalityOfARotationDoesNotMoveTheContact) {
  const Opened box(box_content(uniform()));
  for (const double skew : {3e-8, 5e-4}) {
    Contact contact(box.view, 0);
    const auto pose = [&](double depth) {
      Pose result = upright(centre(depth, 0.001));
      result.rotation[6] = skew;
      return result;
    };
    for (int k = -10; k <= 300; ++k) contact.tick(pose(1e-5 * k));
    const Tick first = contact.tick(pose(0.003));
    ASSERT_GT(length(first.force), 0.1);
    Tick last;
    for (int k = 0; k < 20000; ++k) last = contact.tick(pose(0.003));
    EXPECT_EQ(distance(last.force, first.force), 0) << skew;
    EXPECT_EQ(distance(last.body_point, first.body_point), 0) << skew;
  }
}

TEST(Contact, JumpIntoTheBodyBeginsWithoutForce) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0), moved(box.view, 0);
  const double size = contact.size(kDepthScale);
  EXPECT_EQ(contact.tick(upright(centre(0.003 - 1.01 * size))).state, State::free);
  EXPECT_EQ(length(contact.tick(upright(centre(0.003))).force), 0);
  EXPECT_EQ(moved.tick(upright(centre(0.003 - 0.99 * size))).state, State::free);
  const Tick tick = moved.tick(upright(centre(0.003)));
  EXPECT_NEAR(tick.depth, 0.003, 1e-8);
  EXPECT_NEAR(tick.force.z, hertz(0.003), 0.01 * hertz(0.003));
}

TEST(Contact, JumpAcrossTheBodyDoesNotRaiseTheForce) {
  Options options;
  options.subdivision = 3;
  for (const bool friction : {false, true}) {
    options.friction = friction;
    const Opened body(ball_content(options));
    for (int k = 1; k < 12; ++k) {
      Contact contact(body.view, 0);
      const double angle = std::numbers::pi * k / 12, far = kBallRadius + kTipRadius;
      for (int i = 0; i <= 200; ++i) contact.tick(upright({0, 0, far + 0.001 - 1e-5 * i}));
      const double before = length(contact.tick(upright({0, 0, far - 0.001})).force);
      ASSERT_GT(before, 0.01);
      const double r = far - 0.006;
      const Vec3 at = {r * std::sin(angle), 0, r * std::cos(angle)};
      if (distance(at, {0, 0, far - 0.001}) < contact.size(kDepthScale)) continue;  // that is a motion
      const Tick there = contact.tick(upright(at));
      EXPECT_LE(length(there.force), before) << k << " friction " << friction;
    }
  }
}

TEST(Contact, ResetForgetsTheContact) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  move(contact, centre(-0.001), centre(0.003));
  contact.reset();
  EXPECT_FALSE(contact.state().touching);
  EXPECT_EQ(length(contact.tick(upright(centre(0.003))).force), 0);
}

// As the README says of a host that opens another file while the tool presses.
TEST(Contact, NewFileTakesOverThroughATickOutsideAndOneAtThePose) {
  const Opened hard(box_content(flat()));
  ResponseFileContent softer = box_content(flat());
  for (Response& response : softer.responses) response.unit *= 0.5F;
  const Opened soft(softer);
  Contact contact(hard.view, 0);
  move(contact, centre(-1e-4), centre(0.003));
  const Tick before = move(contact, centre(0.003), centre(0.003, 5e-4));
  EXPECT_GT(before.force.x * before.force.x, 1e-6);
  const Pose pose = upright(centre(0.003, 5e-4));
  contact = Contact(soft.view, 0);
  EXPECT_EQ(contact.tick(upright(centre(-1e-4, 5e-4))).state, State::free);
  const Tick after = contact.tick(pose);
  EXPECT_EQ(after.state, State::stick);
  EXPECT_LT(distance(after.force, {0, 0, 0.5 * hertz(0.003)}), 1e-3);
}

TEST(Contact, TorqueIsTheLeverTimesTheForce) {
  const Opened ball(ball_content());
  Contact contact(ball.view, 0);
  const Vec3 direction = unit(Vec3{0.3, 0.5, 0.8}, {0, 0, 1});
  Tick tick;
  Pose pose;
  for (int i = 0; i <= 400; ++i) {
    pose = upright((kBallRadius + kTipRadius + 0.001 - 1e-5 * i) * direction);
    tick = contact.tick(pose);
  }
  ASSERT_GT(length(tick.force), 0.1);
  EXPECT_LT(distance(tick.torque, cross(tick.tool_point - pose.translation, tick.force)), 1e-15);
  EXPECT_NEAR(distance(tick.tool_point, pose.translation), kTipRadius, 1e-9);
  EXPECT_GT(dot(tick.force, direction), 0);
}

TEST(Contact, BodyPointFollowsTheToolRoundABall) {
  Options options = flat();
  options.subdivision = 4;
  const Opened ball(ball_content(options));
  Contact contact(ball.view, 0);
  for (int i = 0; i <= 300; ++i) contact.tick(upright({0, 0, kBallRadius + kTipRadius + 0.001 - 1e-5 * i}));
  for (int i = 0; i <= 20000; ++i) {
    const double a = 2 * i / 20000.0, r = kBallRadius + kTipRadius - 0.002;
    const Vec3 q = {r * std::sin(a), 0, r * std::cos(a)};
    const Tick tick = contact.tick(upright(q));
    ASSERT_LT(distance(tick.body_point, (kBallRadius / r) * q), 0.003);
    ASSERT_NEAR(tick.depth, 0.002, 4e-4);
  }
}

TEST(Contact, TemporaryViewDoesNotCompile) {
  using runtime::View;
  const auto refuses = [](auto type) {
    using Kept = typename decltype(type)::type;
    return std::is_constructible_v<Kept, const View&, std::uint32_t> &&
           std::is_constructible_v<Kept, View&, std::uint32_t> && !std::is_constructible_v<Kept, View, std::uint32_t> &&
           !std::is_constructible_v<Kept, const View, std::uint32_t>;
  };
  static_assert(refuses(std::type_identity<Contact>()));
  static_assert(refuses(std::type_identity<runtime::ContactSet<2>>()));
  static_assert(std::is_constructible_v<runtime::DeformingSurface, const View&, void*>);
  static_assert(!std::is_constructible_v<runtime::DeformingSurface, View, void*>);
}

Options everything() {
  Options options;
  options.tools = Options::Tools::all;
  options.subdivision = 3;
  options.search = true;
  options.softening = true;
  options.spins = 4;
  return options;
}

// Wandering round and into the ball: smooth, with jumps and spins now and then.
class Wander {
public:
  explicit Wander(unsigned seed) : random_(seed) {}
  Pose next() {
    std::normal_distribution<double> normal;
    const auto kick = [&](double size) { return size * normal(random_); };
    velocity_ = 0.995 * velocity_ + Vec3{kick(4e-6), kick(4e-6), kick(4e-6)} - 2e-5 * at_;
    at_ = at_ + velocity_;
    turn_ = turn_ + Vec3{kick(2e-3), kick(2e-3), kick(2e-3)};
    if (random_() % 5000 == 0) at_ = Vec3{kick(0.05), kick(0.05), kick(0.05)};
    if (random_() % 7000 == 0) turn_ = Vec3{kick(2), kick(2), kick(2)};
    return Pose::from_quaternion(1, turn_.x, turn_.y, turn_.z, at_);
  }

private:
  std::mt19937 random_;
  Vec3 at_{0, 0, 0.05}, velocity_, turn_;
};

TEST(ForceLoop, OpeningAndTickingAllocateNothing) {
  const Opened ball(ball_content(everything()));
  Wander wander(31);
  const long before = allocations();
  const runtime::OpenResult opened = runtime::View::open(ball.bytes.data(), ball.bytes.size());
  long touched = 0;
  for (std::uint32_t tool = 0; tool < 3; ++tool) {
    Contact contact(opened.view, tool);
    runtime::ContactSet<3> set(opened.view, tool);
    for (int i = 0; i < 5000; ++i) {
      const Pose pose = wander.next();
      touched += contact.tick(pose).depth > 0;
      touched += set.tick(pose).depth > 0;
    }
  }
  EXPECT_EQ(allocations() - before, 0);
  EXPECT_GT(touched, 1000);
}

TEST(ForceLoop, SameMotionGivesTheSameBits) {
  const auto run = [] {
    const Opened ball(ball_content(everything()));
    checksum::Xxh64 hash;
    for (std::uint32_t tool = 0; tool < 3; ++tool) {
      Contact contact(ball.view, tool);
      Wander wander(32);
      for (int i = 0; i < 10000; ++i) {
        const Tick tick = contact.tick(wander.next());
        const double values[] = {tick.force.x, tick.force.y, tick.force.z, tick.torque.x, tick.torque.y, tick.torque.z};
        hash.update(values, sizeof values);
      }
    }
    return hash.digest();
  };
  EXPECT_EQ(run(), run());
}

TEST(ForceLoop, RandomMotionsGiveFiniteBoundedForces) {
  for (const bool friction : {false, true}) {
    Options options = everything();
    options.friction = options.softening = friction;
    const Opened ball(ball_content(options));
    for (std::uint32_t tool = 0; tool < 3; ++tool) {
      Contact contact(ball.view, tool);
      Wander wander(33 + tool);
      int stuck = 0, slid = 0;
      for (int i = 0; i < 25000; ++i) {
        const Tick tick = contact.tick(wander.next());
        const double size = length(tick.force);
        // The response continues linearly beyond its range: a body of 60 mm bounds it.
        ASSERT_TRUE(std::isfinite(size) && size < 500) << i;
        ASSERT_TRUE(std::isfinite(length(tick.torque)));
        ASSERT_TRUE(size == 0 || tick.depth > 0);
        ASSERT_GE(tick.depth, tick.counted_depth);
        ASSERT_GE(tick.counted_depth, 0);
        ASSERT_NE(tick.state, State::fault);
        stuck += tick.state == State::stick;
        slid += tick.state == State::slide;
      }
      EXPECT_GT(slid, 200);
      EXPECT_EQ(stuck > 200, friction);
    }
  }
}

TEST(ForceLoop, WildPosesGiveFiniteForces) {
  const Opened ball(ball_content(everything()));
  std::mt19937 random(34);
  std::normal_distribution<double> normal;
  for (std::uint32_t tool = 0; tool < 3; ++tool) {
    Contact contact(ball.view, tool);
    for (int i = 0; i < 1500; ++i) {
      const double scale = std::pow(10.0, static_cast<int>(random() % 9) - 4);
      const Vec3 at{scale * normal(random), scale * normal(random), scale * normal(random)};
      const Tick tick =
          contact.tick(Pose::from_quaternion(normal(random), normal(random), normal(random), normal(random), at));
      ASSERT_TRUE(std::isfinite(length(tick.force)) && std::isfinite(length(tick.torque)));
    }
  }
}

// A joint solve ticks a contact several times from one state.
TEST(ForceLoop, RestoredContactHasTheSameForces) {
  for (const bool friction : {true, false}) {
    const Opened ball(ball_content(flat(friction)));
    const double reach = kBallRadius + kTipRadius;
    const auto at = [&](double angle, double depth) {
      return upright((reach - depth) * Vec3{std::sin(angle), 0, std::cos(angle)});
    };
    Contact contact(ball.view, 0);
    for (int i = 0; i <= 100; ++i) contact.tick(at(0, -0.001 + 4e-5 * i));
    for (int start = 0; start < 20; ++start) {
      const Contact::Memory memory = contact.memory();
      Tick first[15], again;
      const auto pose = [&](int i) { return at(0.02 * (start + 0.1 * i), 0.003 + 2e-4 * (i % 5) - 4e-4 * (i / 12)); };
      for (int i = 0; i < 15; ++i) first[i] = contact.tick(pose(i));
      contact.restore(memory);
      for (int i = 0; i < 15; ++i) {
        again = contact.tick(pose(i));
        ASSERT_EQ(again.state, first[i].state) << start << ' ' << i;
        ASSERT_LT(distance(again.force, first[i].force), 1e-9 * length(first[i].force) + 1e-12) << start << ' ' << i;
      }
    }
  }
}

TEST(ForceLoop, ContactIsAtMost4KilobytesLarge) {
  static_assert(sizeof(Contact) <= 4096);
  static_assert(std::is_trivially_copyable_v<Contact>, "a virtual coupling copies contacts in every tick");
}

}  // namespace
}  // namespace palpate::contact_test
