// SPDX-License-Identifier: GPL-3.0-or-later
// Gross sliding on a block: Coulomb's law at every point, the force, the energy, ways in from the side.
#include "precompute/solve/reference/slide.hpp"

#include "formats/io/error.hpp"
#include "precompute/solve/push/coulomb_push.hpp"
#include "tests/support/bodies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace palpate::solve {
namespace {

class Sliding : public ::testing::Test {
protected:
  ToolScene sphere;
  SlidePath path;
  PairOptions options;
  double half = 0.0;

  Sliding() {
    sphere.radius = 0.01;
    path.depth = 0.01 * sphere.radius;
    options.mesh_size = 0.5;
    half = 15 * std::sqrt(sphere.radius * path.depth);
  }

  SlideResult slide() const {
    const Body body = test::block_body(half, 5e3, 0.49);
    const tool::Tool tool = tool::make_tool(sphere);
    return solve_slide({body, tool, tool.vertices[0], ContactFrame{}}, path, options);
  }
};

TEST_F(Sliding, ForceIsMuTimesTheNormalForceOnABlock) {
  path.radii = 3.2;
  path.step = 0.2;
  const SlideResult r = slide();
  ASSERT_TRUE(r.usable) << r.cause;
  EXPECT_NEAR(r.ratio / path.friction, 1.0, 0.02);
  EXPECT_NEAR(r.predicted / path.friction, 1.0, 0.02);
  EXPECT_NEAR(r.local_ratio / path.friction, 1.0, 0.005);
  EXPECT_LT(r.spread, 0.02);
  EXPECT_LT(std::abs(r.imbalance), 0.03);
  EXPECT_GE(r.steps.back().travelled, 3 * r.contact_radius);
  // Where Cattaneo and Mindlin let all of it slip.
  EXPECT_NEAR(r.gross_at / (gross_slip_reach(path.friction, 0.49) * path.depth), 1.0, 0.3);
  double last = 0.0;
  for (const SlideStep& s : r.steps) {
    EXPECT_GE(s.dissipated, last);
    last = s.dissipated;
    EXPECT_LT(std::abs(s.force.y()), 0.01 * s.force.z());
  }
}

// Every point obeys Coulomb's law, and yet the force ratio is a third more: tissue piles up before the tool.
TEST_F(Sliding, OnADeepContactTheForceRatioPassesMu) {
  sphere.radius = 0.005;
  path.depth = 0.004;
  path.radii = 1.5;
  path.step = 0.15;
  half = 0.03;
  options.mesh_size = 0.5;
  const SlideResult r = slide();
  ASSERT_TRUE(r.usable) << r.cause;
  EXPECT_NEAR(r.local_ratio / path.friction, 1.0, 0.01);
  EXPECT_GT(r.predicted, 1.05 * path.friction);
  EXPECT_GT(r.ratio, 1.1 * r.predicted);
  EXPECT_LT(std::abs(r.imbalance), 0.03);
}

TEST_F(Sliding, AWayInFromTheSideHasSlippedBeforeItArrives) {
  path.radii = 0.4;
  path.step = 0.2;
  for (const double side : {-1.0, 1.0}) {
    path.approach = 1.2 * side;
    const SlideResult r = slide();
    ASSERT_TRUE(r.usable) << r.cause;
    const SlideStep& arrived = r.steps.front();
    EXPECT_NEAR(arrived.force.x() / arrived.force.z() / (side * path.friction), 1.0, 0.03);
    EXPECT_NEAR(r.ratio / path.friction, 1.0, 0.02);
  }
}

TEST_F(Sliding, WaysThatLeaveTheSurfaceOrAreOutOfRangeAreRefusedByName) {
  path.radii = 20;
  const SlideResult r = slide();
  EXPECT_FALSE(r.usable);
  EXPECT_EQ(r.cause.rfind("path: the surface", 0), 0U) << r.cause;
  EXPECT_TRUE(r.steps.empty());
  for (const double wrong : {-1.0, std::numeric_limits<double>::quiet_NaN(), 1e9}) {
    path.radii = wrong;
    EXPECT_THROW(slide(), Error);
  }
}

// A way too short for the whole contact to slip is no gross sliding.
TEST_F(Sliding, AWayOfPartialSlipIsNotUsable) {
  path.radii = 0.03;
  const SlideResult r = slide();
  EXPECT_FALSE(r.usable);
  EXPECT_EQ(r.cause.rfind("gross sliding", 0), 0U) << r.cause;
  EXPECT_GT(r.steps.back().force.x(), 0);
}

}  // namespace
}  // namespace palpate::solve
