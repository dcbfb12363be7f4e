// SPDX-License-Identifier: GPL-3.0-or-later
// A tool that holds on: taken over without a step, pulled out and aside, no work in loops; files that have no grasp.
#include "palpate/contact/bonded_contact.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "formats/error.hpp"
#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;
using runtime::Grasp;
using runtime::GraspField;

constexpr double kDepth = 0.002;

Options grasping(bool like = true) {
  Options options = uniform();
  options.uniform = like;
  options.lateral = false;
  options.grasp = true;
  return options;
}

Pose at(double depth, double x = 0, double y = 0) { return upright({x, y, kTop + kTipRadius - depth}); }

// Pressed to `depth` from outside.
Tick press(Contact& contact, double depth) {
  Tick tick;
  for (int k = -5; k <= 100; ++k) tick = contact.tick(at(depth * k / 100));
  return tick;
}

TEST(Grasp, TakesTheContactOverWithItsForceAndAnswersPulls) {
  const Opened box(box_content(grasping()));
  Contact contact(box.view, 0);
  const Tick pressed = press(contact, kDepth);
  ASSERT_EQ(pressed.state, State::stick);
  Grasp grasp(box.view, 0, at(kDepth), pressed);
  ASSERT_TRUE(grasp.holds());
  EXPECT_LT(distance(grasp.tick(at(kDepth)).force, pressed.force), 1e-6);
  // From there on the sample's straight line of kGraspStiffness.
  for (const double depth : {0.001, 0.0, -0.001, -0.002}) {
    const Tick tick = grasp.tick(at(depth));
    EXPECT_EQ(tick.state, State::stick);
    EXPECT_NEAR(tick.force.z, pressed.force.z + kGraspStiffness * (depth - kDepth), 1e-5);
    EXPECT_LT(std::hypot(tick.force.x, tick.force.y), 1e-6);
    EXPECT_LT(distance(tick.body_point, pressed.body_point), 1e-12);
    EXPECT_FALSE(tick.beyond);
  }
  EXPECT_TRUE(grasp.tick(at(-2 * kDepthScale)).beyond);
  // Aside it answers against the way, and does not slide.
  const Tick aside = grasp.tick(at(-0.001, 0.003, 0.001));
  EXPECT_LT(aside.force.x, -0.003 * kGraspSideways);
  EXPECT_NEAR(aside.force.x / aside.force.y, 3.0, 1e-5);
  EXPECT_LT(distance(aside.torque, cross(aside.tool_point - at(-0.001, 0.003, 0.001).translation, aside.force)), 1e-12);
  EXPECT_TRUE(std::isinf(aside.friction_limit));
}

// Ticks of a body that moves are told in the world, grasps in its frame.
TEST(Grasp, TakesOverTheContactOfABodyThatMoves) {
  const Opened box(box_content(grasping()));
  const auto body = [](double t) {
    return turned(1.2 + 0.3 * std::sin(3 * t), unit(Vec3{1, 2, -1}, {}), {0.1, 0.2 * std::sin(2 * t), 0.3});
  };
  Contact rest(box.view, 0);
  runtime::MovingContact moving(box.view, 0);
  Tick still, tick;
  for (int k = -5; k <= 100; ++k) {
    const Pose in = at(kDepth * k / 100, 1e-5 * std::max(k, 0));
    still = rest.tick(in);
    tick = moving.tick(body(0.01 * k), body(0.01 * k) * in);
  }
  const Pose then = body(1), held = at(kDepth, 1e-3);
  Grasp alone(box.view, 0, held, still);
  Grasp grasp(box.view, 0, runtime::seen_from(then, then * held), runtime::carried(inverse(then), tick));
  ASSERT_TRUE(alone.holds());
  ASSERT_TRUE(grasp.holds());
  EXPECT_LT(distance(alone.tick(held).force, still.force), 1e-6);
  for (int k = 0; k < 100; ++k) {
    const Pose now = body(1 + 0.01 * k), pulled = at(kDepth - 4e-5 * k, 1e-3 - 2e-5 * k);
    const Tick expected = runtime::carried(now, alone.tick(pulled));
    const Tick given = runtime::carried(now, grasp.tick(runtime::seen_from(now, now * pulled)));
    ASSERT_EQ(given.state, State::stick);
    ASSERT_LT(distance(given.force, expected.force), 1e-6) << k;
    ASSERT_LT(distance(given.torque, expected.torque), 1e-8) << k;
    ASSERT_LT(distance(given.body_point, expected.body_point), 1e-9) << k;
  }
}

// A contact that is held sideways, or slid before, goes on with the force that it had.
TEST(Grasp, KeepsASidewaysForce) {
  for (const bool like : {true, false}) {
    const Opened box(box_content(grasping(like)));
    Contact contact(box.view, 0);
    press(contact, kDepth);
    Tick last;
    for (int k = 1; k <= 100; ++k) last = contact.tick(at(kDepth, 1e-5 * k, -2e-5 * k));
    ASSERT_GT(std::hypot(last.force.x, last.force.y), 1e-3);
    Grasp grasp(box.view, 0, at(kDepth, 0.001, -0.002), last);
    ASSERT_TRUE(grasp.holds());
    EXPECT_LT(distance(grasp.tick(at(kDepth, 0.001, -0.002)).force, last.force), 1e-6);
  }
}

// Through pulls and pushes, sideways as far as deep, and beyond what was sampled.
TEST(Grasp, DoesNoWorkInClosedMotions) {
  const Opened box(box_content(grasping(false)));
  std::mt19937 random(7);
  const auto draw = [&](double size) { return size * (2 * (static_cast<double>(random()) / 4294967296.0) - 1); };
  for (int trial = 0; trial < 20; ++trial) {
    const runtime::Location top = locate(box.view, {draw(0.02), draw(0.02), kTop + 1e-4});
    const GraspField field(box.view, 0, top.at, {});
    Vec3 corner[4];
    for (Vec3& c : corner) c = {draw(2 * kDepthScale), draw(2 * kDepthScale), draw(2 * kDepthScale)};
    double work = 0, gross = 0;
    for (int side = 0; side < 3; ++side) {
      constexpr int kSteps = 4000;
      const Vec3 step = (1.0 / kSteps) * (corner[(side + 1) % 3] - corner[side]);
      for (int k = 0; k < kSteps; ++k) {
        const double w = dot(field.force(corner[side] + (k + 0.5) * step).force, step);
        work += w;
        gross += std::abs(w);
      }
    }
    EXPECT_LT(std::abs(work), 1e-6 * gross);
  }
}

TEST(Grasp, IsContinuousOverEdges) {
  Options options = grasping(false);
  options.subdivision = 2;
  const Opened ball(ball_content(options));
  std::mt19937 random(43);
  for (int trial = 0; trial < 1000; ++trial) {
    runtime::BodyPoint here{static_cast<std::uint32_t>(random() % ball.view.meta->triangle_count), {0, 0, 0}};
    const int corner = static_cast<int>(random() % 3);
    const double share = static_cast<double>(random()) / 4294967296.0;
    here.bary[(corner + 1) % 3] = share;
    here.bary[(corner + 2) % 3] = 1 - share;
    const GraspField one(ball.view, 0, here, {}), other(ball.view, 0, runtime::cross_edge(ball.view, here, corner), {});
    const Vec3 deflection = 2e-3 * random_direction(random);
    const Vec3 a = one.force(deflection).force, b = other.force(deflection).force;
    ASSERT_LT(distance(a, b), 1e-9 * length(a));
  }
}

TEST(Grasp, NeedsAFileThatHasItAndAContactThatItCanBear) {
  const Opened without(box_content(uniform()));
  Contact contact(without.view, 0);
  const Tick pressed = press(contact, kDepth);
  EXPECT_FALSE(Grasp(without.view, 0, at(kDepth), pressed).holds());
  const Opened box(box_content(grasping()));
  EXPECT_FALSE(Grasp(box.view, 0, at(kDepth), Tick{}).holds());
  Contact other(box.view, 0);
  const Tick good = press(other, kDepth);
  Tick heavy = good;
  heavy.force = {0, 0, 2 * kGraspStiffness * layout::kGraspRange * kDepthScale};
  EXPECT_FALSE(Grasp(box.view, 0, at(kDepth), heavy).holds());
  Grasp grasp(box.view, 0, at(kDepth), good);
  ASSERT_TRUE(grasp.holds());
  Pose broken = at(kDepth);
  broken.translation.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(grasp.tick(broken).state, State::fault);
  EXPECT_FALSE(grasp.holds());
  EXPECT_EQ(grasp.tick(at(kDepth)).state, State::free);
}

// Of a scene with two tools one may hold on; the other's responses are zero.
TEST(Grasp, BelongsToATool) {
  Options options = grasping();
  options.tools = Options::Tools::all;
  const Opened box(box_content(options));
  const runtime::Location top = locate(box.view, {0.003, 0.004, kTop + 1e-4});
  EXPECT_GT(GraspField(box.view, 0, top.at, {}).depth(), 0.0);
  EXPECT_EQ(GraspField(box.view, 1, top.at, {box.view.tools[1].first_patch, {1, 0, 0}}).depth(), 0.0);
  ResponseFileContent mixed = box_content(options);
  Response& odd = mixed.responses[mixed.tool_vertex_count()];  // the ball's at the second site
  odd.grasp_depth = odd.grasp_pulled = 0;
  odd.grasp.assign(odd.grasp.size(), 0.0f);
  EXPECT_THROW(encode(mixed), Error);
}

// What would make energy or end continuity is refused by the reader.
TEST(Grasp, IsRefusedWhereItsCurvesBreakTheRules) {
  const auto refused = [](const std::function<void(Response&)>& spoil) {
    ResponseFileContent content = box_content(grasping());
    spoil(content.responses[3]);
    try {
      encode(content);
    } catch (const Error& error) {
      return std::string(error.what()).find("GRASP: response 3") != std::string::npos;
    }
    return false;
  };
  EXPECT_FALSE(refused([](Response&) {}));
  EXPECT_TRUE(refused([](Response& r) { r.grasp[2 * 6 + 3] = r.grasp[2 * 6 + 2] - 1; }));
  EXPECT_TRUE(refused([](Response& r) { r.grasp[3 * 6] += 1; }));
  EXPECT_TRUE(refused([](Response& r) { r.grasp[3 * 6 + 2] = -1; }));
  EXPECT_TRUE(refused([](Response& r) { r.grasp[4 * 6 + 2] = 2 * r.grasp[3 * 6 + 2]; }));
  EXPECT_TRUE(refused([](Response& r) { r.grasp[0] = std::numeric_limits<float>::infinity(); }));
  EXPECT_TRUE(refused([](Response& r) { r.grasp_pulled = 2 * kDepthScale; }));
}

}  // namespace
}  // namespace palpate
