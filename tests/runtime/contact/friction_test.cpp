// SPDX-License-Identifier: GPL-3.0-or-later
// Friction: sticking, partial slip, sliding at the limit, memory of turning points, softening, edges of the body.
#include "palpate/contact/friction_springs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/runtime/support.hpp"

namespace palpate::friction_test {
namespace {

using namespace test;
using runtime::Contact;
using runtime::Vec2;

constexpr double kStiffest = 3000;  // N/m, above any slope of the sample responses

double across(const Vec3& force) { return std::hypot(force.x, force.y); }

TEST(Friction, SticksThenSlidesAtTheLimit) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  const double depth = 0.004;
  move(contact, centre(-0.001), centre(depth));
  int stuck = 0;
  Tick last;
  move(contact, centre(depth), centre(depth, 0.004), 1e-5, [&](const Pose&, const Tick& tick) {
    EXPECT_NEAR(tick.depth, depth, 1e-8);
    EXPECT_LE(across(tick.force), tick.friction_limit * (1 + 1e-9));
    EXPECT_LT(tick.force.x, 0);
    EXPECT_GE(-tick.force.x, -last.force.x - 1e-6) << "a straight draw only loads";
    stuck += tick.state == State::stick;
    last = tick;
  });
  EXPECT_GT(stuck, 10);
  EXPECT_EQ(last.state, State::slide);
  EXPECT_NEAR(across(last.force), last.friction_limit, 1e-9 * last.friction_limit);
  EXPECT_NEAR(last.friction_limit, 0.3 * hertz(depth), 1e-3);
  EXPECT_GT(last.body_point.x, 0.002) << "c follows the slide";
  EXPECT_EQ(contact.tick(upright(centre(depth, 0.004 - 1e-5))).state, State::stick) << "a reversal sticks";
}

TEST(Friction, StiffnessOfTheFirstMotionIsThatOfTheResponse) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  const double depth = 0.002;
  const Tick before = move(contact, centre(-0.001), centre(depth));
  const runtime::Sym2 k = contact.response().law().at(depth).stiffness;
  const Tick tick = contact.tick(upright(centre(depth, 1e-7)));
  const Vec3 change = tick.force - before.force;
  EXPECT_NEAR(across(change), length(k * Vec2{1e-7, 0}), 0.2 * k.m * 1e-7);
}

TEST(Friction, OpposesTheSlideInEveryDirectionWithTheBiasOnTop) {
  const Opened box(box_content(Options()));
  double most_bias = 0;
  for (int k = 0; k < 8; ++k) {
    const double angle = 0.25 * k * std::numbers::pi, depth = 0.0035;
    const Vec3 to{std::cos(angle), std::sin(angle), 0}, start{-0.0013, 0.0017, 0};
    Contact contact(box.view, 0);
    move(contact, centre(-0.0005) + start, centre(depth) + start);
    const Tick tick = move(contact, centre(depth) + start, centre(depth) + start + 0.006 * to, 1e-5);
    const auto& place = contact.state().place;
    const Vec2 g = contact.response().law().at(tick.counted_depth).bias;
    const Vec3 y = cross(place.normal, place.axis);
    const double kept = response::slipping_bias_share(std::sqrt(depth / kDepthScale));  // slip removes the rest of g
    const Vec3 friction = tangential(tick.force, tick.normal) + (kept * g.x) * place.axis + (kept * g.y) * y;
    EXPECT_NEAR(length(friction), tick.friction_limit, 0.03 * tick.friction_limit) << k;
    EXPECT_LT(dot(friction, to), -0.9 * tick.friction_limit) << k;
    most_bias = std::max(most_bias, length(g) / tick.friction_limit);
  }
  EXPECT_GT(most_bias, 0.03);
}

TEST(Friction, SmallLoopClosesWhereItBegan) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  const double depth = 0.003;
  move(contact, centre(-0.001), centre(depth));
  const double reach = 0.3 * hertz(depth) / contact.response().law().at(depth).stiffness.m;
  const Tick there = move(contact, centre(depth), centre(depth, reach), 1e-6);
  const Tick back = move(contact, centre(depth, reach), centre(depth, 0.3 * reach), 1e-6);
  EXPECT_LT(across(back.force), 0.7 * across(there.force));
  const Tick again = move(contact, centre(depth, 0.3 * reach), centre(depth, reach), 1e-6);
  EXPECT_NEAR(again.force.x, there.force.x, 1e-3 * across(there.force));
}

TEST(Friction, DeepeningKeepsTheTangentialForce) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  const double depth = 0.002, reach = 0.5 * 0.3 * hertz(depth) / 300;
  move(contact, centre(-0.001), centre(depth));
  const Tick before = move(contact, centre(depth), centre(depth, reach), 1e-6);
  ASSERT_EQ(before.state, State::stick);
  const Tick deep = move(contact, centre(depth, reach), centre(1.5 * depth, reach), 1e-5);
  EXPECT_EQ(deep.state, State::stick);
  EXPECT_NEAR(deep.force.x, before.force.x, 1e-3 * across(before.force)) << "new area is unstressed";
}

TEST(Friction, LiftUnderLoadEndsWithoutForce) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  move(contact, centre(-0.001), centre(0.003));
  move(contact, centre(0.003), centre(0.003, 0.0004), 1e-6);
  Vec3 last{0, 0, 1};
  int released = 0;
  move(contact, centre(0.003, 0.0004), centre(-1e-4, 0.0004), 1e-6, [&](const Pose&, const Tick& tick) {
    EXPECT_LE(across(tick.force), tick.friction_limit * (1 + 1e-9));
    if (tick.state == State::released) {
      ++released;
      EXPECT_LT(length(last), 1e-3);
    }
    last = tick.force;
  });
  EXPECT_EQ(released, 1);
}

TEST(Friction, SlipSoftensTheNormalForce) {
  for (const bool softening : {false, true}) {
    Options options = flat();
    options.softening = softening;
    const Opened box(box_content(options));
    Contact contact(box.view, 0);
    const double depth = 0.003;
    move(contact, centre(-0.001), centre(depth));
    const Tick tick = move(contact, centre(depth), centre(depth, 0.006), 1e-5);
    ASSERT_EQ(tick.state, State::slide);
    const auto r = contact.response().law().at(depth);
    const Vec2 mean = solve(r.stiffness, Vec2{-tick.force.x, -tick.force.y});
    const double coupling = 0.5 * quadratic(r.normal_coupling, mean);
    const double expected = (softening ? 1 - kSoftening * depth / kDepthScale : 1) * r.normal_force + coupling;
    EXPECT_NEAR(tick.force.z, expected, 2e-3 * r.normal_force) << softening;
  }
}

TEST(Friction, SlidingDissipatesTheLimitTimesTheWay) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  move(contact, centre(-0.001), centre(0.003));
  double work = 0;
  Vec3 last = centre(0.003), last_force{0, 0, hertz(0.003)};
  const auto account = [&](const Pose& pose, const Tick& tick) {
    work -= dot(0.5 * (tick.force + last_force), pose.translation - last);
    last = pose.translation;
    last_force = tick.force;
  };
  for (int round = 0; round < 3; ++round) {
    move(contact, centre(0.003), centre(0.003, 0.006, 0.002), 1e-5, account);
    move(contact, centre(0.003, 0.006, 0.002), centre(0.003), 1e-5, account);
  }
  const double limit = 0.3 * hertz(0.003), way = 6 * std::hypot(0.006, 0.002);
  EXPECT_GT(work, 0.5 * limit * way);
  EXPECT_LT(work, limit * way);
}

TEST(Friction, FrictionlessPointFollowsTheToolAndItsStateIsSlide) {
  const Opened box(box_content(flat(false)));
  Contact contact(box.view, 0);
  move(contact, centre(-0.001, -0.01), centre(0.003, -0.01));
  move(contact, centre(0.003, -0.01), centre(0.003, 0.01, 0.003), 2e-5, [](const Pose& pose, const Tick& tick) {
    EXPECT_EQ(tick.state, State::slide);
    EXPECT_TRUE(std::isinf(tick.friction_limit));
    EXPECT_NEAR(tick.body_point.x, pose.translation.x, 1e-5);
    EXPECT_LT(distance(tick.force, {0, 0, hertz(0.003)}), 1e-4);
  });
}

TEST(Slide, ForceIsContinuousOverPatches) {
  Options options;
  options.subdivision = 4;
  for (const bool friction : {true, false}) {
    options.friction = friction;
    const Opened body(ball_content(options));
    Contact contact(body.view, 0);
    constexpr double kStep = 5e-6;
    const auto orbit = [](double angle, double depth) {
      const double r = kBallRadius + kTipRadius - depth;
      return upright({r * std::sin(angle), 0.1 * r * std::sin(3 * angle), r * std::cos(angle)});
    };
    for (int i = 0; i <= 1000; ++i) contact.tick(orbit(0, -0.001 + 0.004 * i / 1000));
    Tick last = contact.tick(orbit(0, 0.003));
    ASSERT_GT(length(last.force), 0.1);
    std::uint32_t patches = 1, patch = body.view.triangle(last.at.triangle).patch;
    for (double angle = 0; angle < 2.5; angle += kStep / kBallRadius) {
      const Tick tick = contact.tick(orbit(angle, 0.003));
      ASSERT_TRUE(tick.touches()) << angle;
      ASSERT_LT(distance(tick.force, last.force), kStiffest * 2 * kStep) << angle << " friction " << friction;
      const std::uint32_t here = body.view.triangle(tick.at.triangle).patch;
      patches += here != patch ? 1 : 0;
      patch = here;
      last = tick;
    }
    EXPECT_GT(patches, 10U);
  }
}

// The normals turn by a right angle within a patch over the edge of the box.
TEST(Slide, ForceIsContinuousOverAnEdge) {
  for (const bool friction : {false, true}) {
    Options options = flat(friction);
    options.subdivision = 3;
    const Opened box(box_content(options));
    Contact contact(box.view, 0);
    constexpr double kDepth = 0.001, kStep = 2e-6, kHalf = kBoxSize / 2;
    move(contact, centre(-0.001, 0.02), centre(kDepth, 0.02));
    Tick last = contact.tick(upright(centre(kDepth, 0.02)));
    double largest = 0;
    const auto watch = [&](const Pose&, const Tick& tick) {
      largest = std::fmax(largest, distance(tick.force, last.force));
      last = tick;
    };
    const double r = kTipRadius - kDepth;
    move(contact, centre(kDepth, 0.02), centre(kDepth, kHalf), kStep, watch);
    for (int i = 0; i <= 4000; ++i) {
      const double angle = std::numbers::pi / 2 * i / 4000;
      const Pose pose = upright({kHalf + r * std::sin(angle), 0, kTop + r * std::cos(angle)});
      watch(pose, contact.tick(pose));
    }
    move(contact, {kHalf + r, 0, kTop}, {kHalf + r, 0, 0}, kStep, watch);
    EXPECT_LT(largest, kStiffest * 2 * kStep) << friction;
    EXPECT_GT(last.force.x, 0.05) << "it presses on the side now";
  }
}

// Deep in the box the closest point leaps from the top to the side; the force turns as far as the tool goes.
TEST(Slide, DeepTurnToAnotherSideIsAtABoundedRate) {
  for (const double depth : {0.012, 0.016}) {
    for (const double stride : {2e-6, 4e-4}) {
      Options options = flat(false);
      options.subdivision = 3;
      const Opened box(box_content(options));
      Contact contact(box.view, 0);
      move(contact, centre(-0.001, 0.02), centre(depth, 0.02));
      Tick last = contact.tick(upright(centre(depth, 0.02)));
      double largest = 0;
      move(contact, centre(depth, 0.02), centre(depth, 0.034), stride, [&](const Pose&, const Tick& tick) {
        ASSERT_LT(length(tick.force), length(last.force) + kStiffest * 2 * stride);
        largest = std::fmax(largest, distance(tick.force, last.force));
        last = tick;
      });
      EXPECT_LT(largest, kStiffest * 5 * stride) << depth << " " << stride;
      EXPECT_GT(last.force.x, 0) << depth << " " << stride;
    }
  }
}

TEST(FrictionSprings, LimitsSumToTheFrictionConeAtEveryDepth) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  move(contact, centre(-0.001), centre(0.001));
  runtime::FrictionLayers layers;
  layers.set(contact.response().law(), kSoftening);
  for (const double z : {1e-6, 2e-5, 3e-4, 0.001, 0.003, 0.005, 0.0065}) {
    runtime::SpringState state;
    const auto r = contact.response().law().at(z);
    const auto f = update_springs(layers, r, {0, z, {1.0, 0.0}}, state);  // far beyond every limit
    EXPECT_TRUE(f.slides);
    const double lost = kSoftening * std::min(1.0, z / kDepthScale);
    EXPECT_NEAR(length(f.force), (1 - lost) * r.friction_coefficient * r.normal_force, 1e-6 * r.normal_force) << z;
    const auto again = update_springs(layers, r, {z, z, {1.0, 0.0}}, state);
    EXPECT_NEAR(again.lost_force, lost * r.normal_force, 1e-6 * r.normal_force) << "all layers have slipped";
    EXPECT_NEAR(again.lost_work, lost * r.work, 1e-3 * r.work) << z;
    const double kept = response::slipping_bias_share(std::sqrt(std::min(1.0, z / kDepthScale)));
    EXPECT_NEAR(again.lost_bias, 1 - kept, 1e-6) << z;
  }
}

TEST(FrictionSprings, RestChangesNothing) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  move(contact, centre(-0.001), centre(0.001));
  runtime::FrictionLayers layers;
  layers.set(contact.response().law(), kSoftening);
  for (const double z : {2e-5, 0.001, 0.004}) {
    for (const double way : {1e-6, 1e-4, 1e-3}) {
      runtime::SpringState state;
      const auto r = contact.response().law().at(z);
      update_springs(layers, r, {0, z, {0.6 * way, 0.8 * way}}, state);
      const auto first = update_springs(layers, r, {z, z, {}}, state);
      for (int k = 0; k < 100; ++k) {
        const auto again = update_springs(layers, r, {z, z, {}}, state);
        ASSERT_EQ(again.force.x, first.force.x) << z << ' ' << way;
        ASSERT_EQ(again.force.y, first.force.y) << z << ' ' << way;
      }
    }
  }
}

}  // namespace
}  // namespace palpate::friction_test
