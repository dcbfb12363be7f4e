// SPDX-License-Identifier: GPL-3.0-or-later
// Two tips on one block: what adding single contacts leaves out falls with their distance, as elasticity says.
#include "precompute/solve/reference/two_tips.hpp"

#include "formats/io/error.hpp"
#include "tests/support/bodies.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

TEST(TwoTips, DifferenceToTheSumFallsWithTheDistance) {
  ToolScene sphere;
  sphere.radius = 0.01;
  TwoTipsPath path;
  path.depth = 0.01 * sphere.radius;
  path.steps = 2;
  const double a = std::sqrt(sphere.radius * path.depth), block = 30 * a;
  const Body body = test::block_body(block, 5e3, 0.49);
  const Tool tool = make_tool(sphere);
  PairOptions options;
  options.mesh_size = 0.5;
  double last = 0.5;  // two tips at one place are one
  for (const double spacing : {1.0, 4.0, 8.0}) {
    path.spacing = spacing * a;
    const TwoTipsResult r = solve_two_tips(body, tool, tool.vertices[0], ContactFrame{}, path, options);
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

TEST(TwoTips, PlacesWithoutSurfaceAndPathsOutOfRangeAreRefusedByName) {
  const Body body = test::block_body(0.03, 5e3, 0.49);
  const Tool tool = make_tool(ToolScene{});
  TwoTipsPath path;
  path.depth = 0.001;
  path.spacing = 0.05;
  const TwoTipsResult r = solve_two_tips(body, tool, tool.vertices[0], ContactFrame{}, path, {});
  EXPECT_FALSE(r.usable);
  EXPECT_EQ(r.cause.rfind("second tip", 0), 0U) << r.cause;
  path.spacing = 0;
  EXPECT_THROW(solve_two_tips(body, tool, tool.vertices[0], ContactFrame{}, path, {}), Error);
}

}  // namespace
}  // namespace palpate
