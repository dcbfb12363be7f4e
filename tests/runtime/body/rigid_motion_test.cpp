// SPDX-License-Identifier: GPL-3.0-or-later
// A body that moves rigidly: the force is that of the relative motion.
#include "palpate/body/rigid_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/runtime/support.hpp"

namespace palpate::rigid_motion_test {
namespace {

using namespace test;
using runtime::Contact;
using runtime::RigidMotion;

// Breathing, and swinging about an axis beside the box.
Pose swinging(double t) {
  return turned(0.4 * std::sin(3 * t), unit(Vec3{1, 2, -1}, {}), {0.02 * std::sin(7 * t), 0.5, 0.01 * t});
}

TEST(RigidMotion, ForceIsThatOfTheBodyAtRest) {
  const Opened box(box_content({}));
  Contact rest(box.view, 0), moving(box.view, 0);
  int slid = 0, stuck = 0;
  for (double t = 0; t < 3; t += 5e-4) {
    const Pose body = swinging(t);
    const Tick a = rest.tick(probing(t)), b = moving.tick(body * probing(t), RigidMotion{&box.view, body});
    ASSERT_EQ(a.touches(), b.touches()) << t;
    ASSERT_LT(distance(body.rotate(a.force), b.force), 1e-6 * (1 + length(a.force))) << t;
    ASSERT_LT(distance(body.rotate(a.torque), b.torque) / 0.005, 2e-6 * (1 + length(a.force))) << t;
    if (a.touches()) {
      ASSERT_LT(distance(body.apply(a.body_point), b.body_point), 1e-7) << t;
      ASSERT_LT(distance(body.apply(a.tool_point), b.tool_point), 1e-7) << t;
      ASSERT_LT(distance(body.rotate(a.normal), b.normal), 1e-6) << t;
    }
    stuck += a.state == State::stick;
    slid += a.state == State::slide;
  }
  EXPECT_GT(stuck, 100);
  EXPECT_GT(slid, 100);
}

TEST(RigidMotion, BodyThatPressesItselfOnAToolIsFeltWithoutAStep) {
  const Opened box(box_content({}));
  Contact contact(box.view, 0);
  const Pose tool = upright({0, 0, kTop + kTipRadius + 0.001});
  Vec3 last;
  double most = 0, work = 0;
  constexpr double kRise = 1e-6;  // m
  for (int i = 0; i <= 8000; ++i) {
    const double up = kRise * (i < 4000 ? i : 8000 - i);
    const Tick tick = contact.tick(tool, RigidMotion{&box.view, upright({0, 0, up})});
    ASSERT_LT(distance(tick.force, last), 3000 * 2 * kRise) << i;
    work += dot(tick.force, Vec3{0, 0, (i < 4000 ? 1 : -1) * kRise});
    most = std::fmax(most, tick.force.z);
    last = tick.force;
  }
  EXPECT_GT(most, 0.5);
  EXPECT_EQ(length(last), 0);
  EXPECT_NEAR(work, 0, 1e-3 * most * 0.003) << "the body gets back what it gave";
}

// Each pose as far from orthonormal as it may be; together they are farther.
TEST(RigidMotion, AnyTwoValidPosesAreAccepted) {
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
  for (int i = 0; i < 1000; ++i) {
    const Pose at = turned(2, random_direction(random), random_direction(random));
    const Pose body = loose(at), tool = loose(at * probing(1e-3 * i));
    beyond += !(inverse(body) * tool).valid();
    const Pose seen = runtime::in_body(tool, body);
    ASSERT_TRUE((seen * inverse(seen)).valid());
    ASSERT_LT(distance(seen.rotate({1, 2, 3}), (inverse(body) * tool).rotate({1, 2, 3})), 0.01);
    ASSERT_NE(Contact(box.view, 0).tick(tool, RigidMotion{&box.view, body}).state, State::fault) << i;
  }
  EXPECT_GT(beyond, 50);
}

// Rotations rounded to float, and as far from orthonormal as they may be.
TEST(RigidMotion, HandAtRestHasAConstantForce) {
  const Opened box(box_content({}));
  for (const double scale : {0.0, 1 + 1e-5, 1 - 4e-4}) {
    RigidMotion body{&box.view, turned(1.2, unit(Vec3{1, 2, -1}, {}), {0.4, -0.2, 1.1})};
    for (double& r : body.pose.rotation) r = scale > 0 ? scale * r : double{static_cast<float>(r)};
    ASSERT_TRUE(body.valid());
    const Pose frame = orthonormal(body.pose);
    Contact contact(box.view, 0), alone(box.view, 0);
    Tick tick, still;
    for (int k = -10; k <= 200; ++k) {
      const Pose pose = upright(centre(3e-5 * std::min(k, 100), 2e-6 * std::max(0, k - 100)));
      tick = contact.tick(frame * pose, body);
      still = alone.tick(pose);
    }
    EXPECT_EQ(tick.state, State::stick);
    EXPECT_LT(distance(tick.force, frame.rotate(still.force)), 1e-6);
    const Pose held = frame * upright(centre(0.003, 2e-4));
    for (int k = 0; k < 1000; ++k) {
      const Tick later = contact.tick(held, body);
      ASSERT_EQ(distance(later.force, tick.force), 0) << scale << ' ' << k;
      ASSERT_EQ(distance(later.torque, tick.torque), 0) << scale << ' ' << k;
    }
  }
}

}  // namespace
}  // namespace palpate::rigid_motion_test
