// SPDX-License-Identifier: GPL-3.0-or-later
// Tools together on one block: the error of adding single contacts falls with their distance, as elasticity says.
#include "precompute/solve/reference/together.hpp"

#include "formats/io/error.hpp"
#include "tests/support/bodies.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace palpate::solve {
namespace {

ToolScene sphere_of_10_mm() {
  ToolScene sphere;
  sphere.radius = 0.01;
  return sphere;
}

/// Tools a hundredth of the sphere's radius deep at the frame's origin.
TogetherPath shallow_path(std::size_t tools, int steps) {
  TogetherPath path;
  path.depth = 0.01 * sphere_of_10_mm().radius;
  path.steps = steps;
  path.places.resize(tools);
  return path;
}

const double kRadius = std::sqrt(sphere_of_10_mm().radius * shallow_path(1, 1).depth);  // m, Hertz' contact

TEST(Together, DifferenceToTheSumFallsWithTheDistance) {
  TogetherPath path = shallow_path(2, 2);
  const double a = kRadius, block = 30 * a;
  const Body body = test::block_body(block, 5e3, 0.49);
  const tool::Tool tool = tool::make_tool(sphere_of_10_mm());
  PairOptions options;
  options.mesh_size = 0.5;
  double last = 0.5;  // two tips at one place are one
  for (const double spacing : {1.0, 4.0, 8.0}) {
    path.places[1].origin.x() = spacing * a;
    const TogetherResult r = solve_together(body, tool, tool.vertices[0], path, options);
    ASSERT_TRUE(r.usable) << r.cause;
    EXPECT_NEAR(r.alone[0].z() / r.alone[1].z(), 1, 0.02);
    EXPECT_NEAR(r.together[0].z() / r.together[1].z(), 1, 0.02);
    EXPECT_LT(r.difference, last) << spacing;
    last = r.difference;
    // Each sinks into the other's dent: F / (pi E*) (1 / r - 1.78 / h), h the block's thickness (the far term as in
    // Dimitriadis 2002), and F ~ d^1.5.
    if (spacing < 4) continue;
    const double dent = 4 / (3 * M_PI) * (1 / spacing - 1.78 * a / block);
    EXPECT_NEAR(r.difference, 1 - std::pow(1 + dent, -1.5), 0.015) << spacing;
  }
}

// The middle one of three tools in a row lies in two dents.
TEST(Together, MiddleOfThreeHasTheLeastForce) {
  TogetherPath path = shallow_path(3, 2);
  const double a = kRadius;
  path.places[1].origin.x() = 3 * a;
  path.places[2].origin.x() = -3 * a;
  const tool::Tool tool = tool::make_tool(sphere_of_10_mm());
  PairOptions options;
  options.mesh_size = 0.6;
  const TogetherResult r = solve_together(test::block_body(12 * a, 5e3, 0.49), tool, tool.vertices[0], path, options);
  ASSERT_TRUE(r.usable) << r.cause;
  EXPECT_LT(r.together[0].z(), 0.97 * r.together[1].z());
  EXPECT_NEAR(r.together[1].z() / r.together[2].z(), 1, 0.02);
  EXPECT_LT(r.together[1].z(), 0.95 * r.alone[1].z());
}

// Mindlin: a sticking contact of nu = 0.49 resists a small way aside with (1 - nu) / (1 - nu / 2) of its normal
// stiffness.
TEST(Together, ContactThatSticksResistsAWayAside) {
  TogetherPath path = shallow_path(1, 3);
  path.sticking = true;
  path.aside = 0.1 * path.depth;
  const double a = kRadius;
  const tool::Tool tool = tool::make_tool(sphere_of_10_mm());
  PairOptions options;
  options.mesh_size = 0.5;
  const TogetherResult r = solve_together(test::block_body(12 * a, 5e3, 0.49), tool, tool.vertices[0], path, options);
  ASSERT_TRUE(r.usable) << r.cause;
  const double normal_stiffness = 1.5 * r.together[0].z() / path.depth;
  EXPECT_NEAR(-r.together[0].x() / path.aside, 0.51 / 0.755 * normal_stiffness, 0.1 * normal_stiffness);
}

// Hertz: F ~ d^1.5. The forces at the depth are those of a push that ends there.
TEST(Together, SingleToolsGoOnToTheirOwnDepth) {
  TogetherPath path = shallow_path(1, 3);
  const tool::Tool tool = tool::make_tool(sphere_of_10_mm());
  PairOptions options;
  options.mesh_size = 0.5;
  const Body body = test::block_body(12 * kRadius, 5e3, 0.49);
  const TogetherResult ends = solve_together(body, tool, tool.vertices[0], path, options);
  path.alone_depth = 1.4 * path.depth;
  const TogetherResult deeper = solve_together(body, tool, tool.vertices[0], path, options);
  ASSERT_TRUE(deeper.usable) << deeper.cause;
  EXPECT_EQ(deeper.alone[0], ends.alone[0]);
  EXPECT_EQ(deeper.pushed_together[0].size(), ends.pushed_together[0].size());
  ASSERT_EQ(deeper.pushed_alone[0].size(), ends.pushed_alone[0].size() + 1);
  const std::array<double, 2> last = deeper.pushed_alone[0].back();
  EXPECT_NEAR(last[0], path.alone_depth, 1e-3 * path.depth);
  EXPECT_NEAR(last[1] / ends.alone[0].z(), std::pow(1.4, 1.5), 0.05);
}

TEST(Together, PathsOutOfRangeAreRefused) {
  const Body body = test::block_body(0.03, 5e3, 0.49);
  const tool::Tool tool = tool::make_tool(ToolScene{});
  TogetherPath path;
  path.depth = 0.001;
  EXPECT_THROW(solve_together(body, tool, tool.vertices[0], path, {}), Error);
  path.places.resize(2);
  path.aside = 0.001;  // without sticking
  EXPECT_THROW(solve_together(body, tool, tool.vertices[0], path, {}), Error);
}

}  // namespace
}  // namespace palpate::solve
