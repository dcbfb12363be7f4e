// SPDX-License-Identifier: GPL-3.0-or-later
// What Hayward and Mahvash (2004) report of their experiments, qualitatively: figure 2 (three tools on a loosely and on
// a well supported sample) and figure 4 (symmetric and skewed sideways answers, the contact point's part).
#include "precompute/geometry/solids.hpp"
#include "precompute/solve/pair.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

using Eigen::Vector3d;

SupportScene held_beyond(const Vector3d& point, const Vector3d& normal) {
  SupportScene support;
  support.point = point;
  support.normal = normal;
  return support;
}

class Paper : public ::testing::Test {
protected:
  Scene scene;

  // A strip of rubber, 80 x 20 mm and `thickness` high, its top in z = 0.
  Body strip(double thickness, bool well_supported) {
    scene.material.young = 2e5;
    scene.supports = well_supported
                         ? std::vector{held_beyond({0, 0, -thickness * (1 - 1e-6)}, {0, 0, 1})}
                         : std::vector{held_beyond({-0.037, 0, 0}, {1, 0, 0}), held_beyond({0.037, 0, 0}, {-1, 0, 0})};
    return prepare_body(scene, box_solid({-0.04, -0.01, -thickness}, {0.04, 0.01, 0}, 0.005, "strip"));
  }

  // Forces (N, contact frame) of a push of `tool` at `site` down to `depth`, along the bake's own path.
  std::vector<Sample> push(const Body& body, const ToolScene& tool_scene, const Vector3d& site, double depth) {
    scene.sampling.normal_points = 8;
    const Tool tool = make_tool(tool_scene);
    ContactFrame frame;
    frame.origin = site;
    const PairResult r = solve_pair(body, tool, tool.vertices[0], frame, bake_path(scene, depth), pair_options(scene));
    EXPECT_TRUE(r.outcome.accepted) << r.outcome.cause;
    return r.samples;
  }

  static ToolScene sphere(double radius) {
    ToolScene tool;
    tool.radius = radius;
    return tool;
  }
  static ToolScene punch(double radius) {
    ToolScene tool = sphere(radius);
    tool.shape = ToolScene::Shape::punch;
    return tool;
  }
};

// The last straight push not deeper than `depth`.
double force_at(const std::vector<Sample>& samples, double depth) {
  double force = 0;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::normal && s.deflection.z() <= depth * 1.001) force = s.force.z();
  }
  return force;
}

TEST_F(Paper, LooselySupportedTheToolHardlyMatters) {
  const Body body = strip(0.004, false);
  const double depth = 0.002;
  const double large = force_at(push(body, sphere(0.008), {0, 0, 0}, depth), depth);
  const double small = force_at(push(body, sphere(0.002), {0, 0, 0}, depth), depth);
  const double flat = force_at(push(body, punch(0.003), {0, 0, 0}, depth), depth);
  EXPECT_NEAR(small / large, 1, 0.15);
  EXPECT_NEAR(flat / large, 1, 0.15);
}

TEST_F(Paper, WellSupportedTheSmallSphereIsAnother) {
  const Body body = strip(0.010, true);
  const double depth = 0.001, at_first = 0.0006;
  const auto large = push(body, sphere(0.008), {0, 0, 0}, depth), small = push(body, sphere(0.001), {0, 0, 0}, depth),
             flat = push(body, punch(0.0015), {0, 0, 0}, depth);
  EXPECT_NEAR(force_at(flat, at_first) / force_at(large, at_first), 1, 0.35);
  EXPECT_LT(force_at(small, at_first) / force_at(large, at_first), 0.5);
}

// Sideways forces at the largest deflection to the right and to the left, over each other.
double skew(const std::vector<Sample>& samples) {
  double right = 0, left = 0, base = 0, reach = 0;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::normal) base = s.force.x();
  }
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::tangential || std::abs(s.deflection.y()) > 1e-9) continue;
    if (std::abs(s.deflection.x()) > reach * 1.01) reach = std::abs(s.deflection.x());
  }
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::tangential || std::abs(s.deflection.y()) > 1e-9) continue;
    if (s.deflection.x() > 0.98 * reach) right = base - s.force.x();
    if (s.deflection.x() < -0.98 * reach) left = s.force.x() - base;
  }
  EXPECT_GT(right, 0);
  EXPECT_GT(left, 0);
  return right / left;
}

TEST_F(Paper, AnInclusionOnOneSideSkewsTheSidewaysAnswer) {
  scene.friction = 0.6;
  const Vector3d site(0, 0, 0);
  const Body plain = strip(0.010, true);
  EXPECT_NEAR(skew(push(plain, sphere(0.004), site, 0.0015)), 1, 0.02);
  RegionScene lump;
  lump.name = "lump";
  lump.shape = RegionScene::Shape::ellipsoid;
  lump.centre = {0.006, 0, -0.0035};
  lump.radii = {0.003, 0.003, 0.003};
  lump.material = scene.material;
  lump.material.young *= 50;
  scene.regions = {lump};
  const Body lumpy = strip(0.010, true);
  EXPECT_GT(std::abs(skew(push(lumpy, sphere(0.004), site, 0.0015)) - 1), 0.05);
}

// Pushed straight down at c, or down beside c and then dragged to the same end point: another force.
TEST_F(Paper, TheForceDependsOnTheFirstContactPoint) {
  scene.friction = 1;
  const Body body = strip(0.010, true);
  const double depth = 0.0015;
  const auto samples = push(body, sphere(0.004), {0, 0, 0}, depth);
  Vector3d straight = Vector3d::Zero(), dragged = Vector3d::Zero();
  double reach = 0;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::normal) straight = s.force;
    if (s.kind != SampleKind::tangential || s.deflection.z() < 0.9 * depth || s.deflection.x() < reach) continue;
    reach = s.deflection.x();
    dragged = s.force;
  }
  ASSERT_GT(reach, 0.1 * depth);
  // The strip is alike all along: at the end point a fresh straight push would answer as at c.
  EXPECT_GT((dragged - straight).norm(), 0.1 * straight.norm());
}

}  // namespace
}  // namespace palpate
