// SPDX-License-Identifier: GPL-3.0-or-later
// A body that moves: only how it moves against the tool is felt.
#include <cmath>
#include <limits>

#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;
using runtime::MovingContact;

// Breathing, and swinging about an axis beside the box.
Pose swinging(double t) {
  return turned(0.4 * std::sin(3 * t), unit(Vec3{1, 2, -1}, {}), {0.02 * std::sin(7 * t), 0.5, 0.01 * t});
}

TEST(Poses, GoThereAndBack) {
  std::mt19937 random(31);
  for (int i = 0; i < 100; ++i) {
    const Pose a = turned(2, random_direction(random), random_direction(random));
    const Pose b = turned(1, random_direction(random), random_direction(random));
    const Vec3 p = random_direction(random);
    EXPECT_LT(distance((a * b).apply(p), a.apply(b.apply(p))), 1e-14);
    EXPECT_LT(distance(inverse(a).apply(a.apply(p)), p), 1e-14);
    EXPECT_TRUE((a * inverse(b)).valid());
  }
}

TEST(MovingContact, AnswersAsTheBodyAtRestToTheSameRelativeMotion) {
  const Opened box(box_content({}));
  Contact rest(box.view, 0);
  MovingContact moving(box.view, 0);
  int slid = 0, stuck = 0;
  for (double t = 0; t < 3; t += 5e-4) {
    const Pose body = swinging(t);
    const Tick a = rest.tick(probing(t)), b = moving.tick(body, body * probing(t));
    ASSERT_EQ(a.state, b.state) << t;
    ASSERT_LT(distance(body.rotate(a.force), b.force), 1e-6 * (1 + length(a.force))) << t;
    ASSERT_LT(distance(body.rotate(a.torque), b.torque), 1e-8) << t;
    if (a.state == State::stick || a.state == State::slide) {
      ASSERT_LT(distance(body.apply(a.body_point), b.body_point), 1e-8) << t;
      ASSERT_LT(distance(body.apply(a.tool_point), b.tool_point), 1e-8) << t;
    }
    stuck += a.state == State::stick;
    slid += a.state == State::slide;
  }
  EXPECT_GT(stuck, 100);
  EXPECT_GT(slid, 100);
}

// A body that rises against a tool at rest, and sinks again.
TEST(MovingContact, ABodyThatPressesItselfOnAToolIsFeltWithoutATear) {
  const Opened box(box_content({}));
  MovingContact contact(box.view, 0);
  const Pose tool = upright({0, 0, kTop + kTipRadius + 0.001});
  Vec3 last;
  double most = 0, work = 0;
  constexpr double kRise = 1e-6;  // m
  for (int i = 0; i <= 8000; ++i) {
    const double up = kRise * (i < 4000 ? i : 8000 - i);
    const Tick tick = contact.tick(upright({0, 0, up}), tool);
    ASSERT_LT(distance(tick.force, last), 3000 * kRise) << i;  // steeper than any response of the sample
    work += dot(tick.force, Vec3{0, 0, (i < 4000 ? 1 : -1) * kRise});
    most = std::fmax(most, tick.force.z);
    last = tick.force;
  }
  EXPECT_GT(most, 0.5);
  EXPECT_EQ(length(last), 0);
  EXPECT_NEAR(work, 0, 1e-3 * most * 0.003);  // what the body gave it got back
}

TEST(MovingContact, AWrongPoseOfTheBodyIsAFaultAndItStartsOver) {
  const Opened box(box_content({}));
  MovingContact contact(box.view, 0);
  const Pose rest = upright({0, 0, 0}), in = upright({0, 0, kTop + kTipRadius - 0.002});
  for (double z = -0.001; z < 0.002; z += 1e-5) {
    EXPECT_NE(contact.tick(rest, upright({0, 0, kTop + kTipRadius - z})).state, State::fault);
  }
  EXPECT_GT(length(contact.tick(rest, in).force), 0.1);
  Pose wrong = rest;
  wrong.rotation[4] = std::numeric_limits<double>::quiet_NaN();
  const Tick fault = contact.tick(wrong, in);
  EXPECT_EQ(fault.state, State::fault);
  EXPECT_EQ(length(fault.force), 0);
  EXPECT_EQ(length(contact.tick(rest, in).force), 0);  // seen anew, deep inside: without force
}

// Each as far from orthonormal as a pose may be: together they are farther.
TEST(MovingContact, AnyTwoPosesThatAreValidMayBeTold) {
  const Opened box(box_content({}));
  std::mt19937 random(41);
  std::uniform_real_distribution<double> off(-4.9e-4, 4.9e-4);
  const auto loose = [&](Pose pose) {
    const Pose good = pose;
    do {
      pose = good;
      const double scale = 1 + off(random);
      for (double& r : pose.rotation) r = scale * r + off(random);
    } while (!pose.valid());
    return pose;
  };
  int beyond = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pose at = turned(2, random_direction(random), random_direction(random));
    const Pose body = loose(at), tool = loose(at * probing(1e-3 * i));
    beyond += !(inverse(body) * tool).valid();
    const Pose seen = runtime::seen_from(body, tool);
    ASSERT_TRUE((seen * inverse(seen)).valid());
    ASSERT_LT(distance(seen.rotate({1, 2, 3}), (inverse(body) * tool).rotate({1, 2, 3})), 0.01);
    ASSERT_NE(MovingContact(box.view, 0).tick(body, tool).state, State::fault) << i;
  }
  EXPECT_GT(beyond, 100);
  const Pose here = upright({9e5, 0, 0}), there = upright({-9e5, 0, 0});
  EXPECT_EQ(MovingContact(box.view, 0).tick(here, there).state, State::fault);
}

}  // namespace
}  // namespace palpate
