// SPDX-License-Identifier: GPL-3.0-or-later
// Closed-form contact laws, through the entry point that the bake uses. The block is at least 40 contact radii
// wide and deep; the displacement it holds back at its bottom is about 0.4 a / L = 1 % of the depth, part of the 2 %.
#include "tests/support/press.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace palpate {
namespace {

constexpr double kYoung = 5e3, kPoisson = 0.49;

TEST(Hertz, SphereForce) {
  const double radius = 0.01, depth = 0.01 * radius, a = std::sqrt(radius * depth);
  const Body body = test::block_body(40 * a, kYoung, kPoisson);
  PairPath path;
  path.normal_depths = {0.25 * depth, 0.5 * depth, 0.75 * depth, depth};
  PairOptions options;
  options.mesh_size = 0.25;
  ToolScene sphere;
  sphere.radius = radius;
  const PairResult r = test::press(body, sphere, path, options);
  ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
  const double stiffness = 4.0 / 3 * kYoung / (1 - kPoisson * kPoisson) * std::sqrt(radius);
  for (const Sample& s : r.samples) {
    if (s.deflection.z() < 0.4 * depth) continue;
    EXPECT_NEAR(s.force.z() / (stiffness * std::pow(s.deflection.z(), 1.5)), 1.0, 0.02) << "depth " << s.deflection.z();
    EXPECT_LT(s.force.head<2>().norm(), 0.01 * s.force.z());
  }
  const Sample& deepest = r.samples.back();
  EXPECT_NEAR(std::sqrt(deepest.contact_area / (std::numbers::pi * radius * deepest.deflection.z())), 1.0, 0.05);
}

// The block's share of the error goes with a / L: twice the block takes half of it away, and two blocks say what is
// left of it without any.
TEST(Hertz, TwiceTheBlockTakesHalfOfItsErrorAway) {
  const double radius = 0.01, depth = 0.01 * radius, a = std::sqrt(radius * depth);
  PairPath path;
  path.normal_depths = {0.5 * depth, depth};
  PairOptions options;
  options.mesh_size = 0.15;
  ToolScene sphere;
  sphere.radius = radius;
  double over_hertz[2];
  for (const int k : {0, 1}) {
    const PairResult r = test::press(test::block_body((k == 0 ? 20 : 40) * a, kYoung, kPoisson), sphere, path, options);
    ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
    const Sample& s = r.samples.back();
    over_hertz[k] = s.force.z() / (4.0 / 3 * kYoung / (1 - kPoisson * kPoisson) * std::sqrt(radius) *
                                   std::pow(s.deflection.z(), 1.5));
  }
  EXPECT_GT(over_hertz[0] - over_hertz[1], 0.005);
  EXPECT_LT(over_hertz[0] - over_hertz[1], 0.025);
  EXPECT_NEAR(2 * over_hertz[1] - over_hertz[0], 1.0, 0.015);
}

TEST(Sneddon, FlatPunchForce) {
  ToolScene punch;
  punch.shape = ToolScene::Shape::punch;
  punch.radius = 0.005;
  punch.edge_radius = 0.01 * punch.radius;
  const double depth = 0.01 * punch.radius;
  const Body body = test::block_body(40 * punch.radius, kYoung, kPoisson);
  PairPath path;
  path.normal_depths = {0.5 * depth, depth};
  const PairResult r = test::press(body, punch, path, {});
  ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
  const Sample& s = r.samples.back();
  EXPECT_NEAR(s.force.z() / (2 * kYoung / (1 - kPoisson * kPoisson) * punch.radius * s.deflection.z()), 1.0, 0.02);
}

// A blunt cone whose rounded tip is small beside the contact.
TEST(Sneddon, ConeForce) {
  ToolScene cone;
  cone.shape = ToolScene::Shape::cone;
  cone.half_angle = 80 * std::numbers::pi / 180;
  cone.radius = 2e-5;
  const double depth = 0.0004, slope = std::tan(cone.half_angle), a = 2 / std::numbers::pi * slope * depth;
  const Body body = test::block_body(40 * a, kYoung, kPoisson);
  PairPath path;
  path.normal_depths = {0.25 * depth, 0.5 * depth, 0.75 * depth, depth};
  PairOptions options;
  options.mesh_size = 0.25;
  const PairResult r = test::press(body, cone, path, options);
  ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
  const double factor = 2 / std::numbers::pi * kYoung / (1 - kPoisson * kPoisson) * slope;
  for (const Sample& s : r.samples) {
    if (s.deflection.z() < 0.4 * depth) continue;
    EXPECT_NEAR(s.force.z() / (factor * s.deflection.z() * s.deflection.z()), 1.0, 0.02);
  }
}

// Mindlin's law is linear: at a depth of a thousandth of the radius the pressure stiffens the surface by less than
// 1 %. Its traction is singular at the rim, which takes a ring of small elements.
TEST(Mindlin, TangentialStiffnessOfAStuckContact) {
  const double radius = 0.01, depth = 0.001 * radius, a = std::sqrt(radius * depth);
  const Body body = test::block_body(80 * a, kYoung, kPoisson);
  PairPath path;
  path.normal_depths = {0.25 * depth, 0.5 * depth, 0.75 * depth, depth};
  path.tangential_depths = {depth};
  path.tangential_directions = 4;
  path.tangential_points = 1;
  path.tangential_reach = 0.1;
  path.friction = 1.0;
  path.form_frictionless = true;
  PairOptions options;
  options.mesh_size = 0.3;
  options.rim_size = 0.05;
  ToolScene sphere;
  sphere.radius = radius;
  const PairResult r = test::press(body, sphere, path, options);
  ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
  const double shear = kYoung / (2 * (1 + kPoisson)), expected = 8 * shear * a / (2 - kPoisson);
  int count = 0;
  for (const Sample& s : r.samples) {
    if (s.kind != SampleKind::tangential) continue;
    const Eigen::Vector2d side = s.deflection.head<2>();
    EXPECT_NEAR(-s.force.head<2>().dot(side) / side.squaredNorm() / expected, 1.0, 0.02);
    ++count;
  }
  EXPECT_EQ(count, 4);
}

}  // namespace
}  // namespace palpate
