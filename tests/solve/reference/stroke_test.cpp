// SPDX-License-Identifier: GPL-3.0-or-later
// A tool drawn through a whole motion on a block: the laws of each of its parts, the energy, what is refused.
#include "precompute/solve/reference/stroke.hpp"

#include "formats/io/error.hpp"
#include "tests/support/bodies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;

class Stroking : public ::testing::Test {
protected:
  ToolScene sphere;
  StrokePath path;
  PairOptions options;
  double depth = 1e-4, radius = 0.0;

  Stroking() {
    sphere.radius = 0.01;
    radius = std::sqrt(sphere.radius * depth);
    options.mesh_size = 0.5;
  }

  StrokeResult stroke() const {
    const Body body = test::block_body(15 * radius, 5e3, 0.49);
    const tool::Tool tool = tool::make_tool(sphere);
    return solve_stroke({body, tool, tool.vertices[0], ContactFrame{}}, path, options);
  }
};

// In, sideways until all slips, back until all slips the other way, out.
TEST_F(Stroking, SticksSlipsTurnsRoundAndLetsGo) {
  path.stations = {{0, 0, 0.1 * depth}};
  for (int k = 1; k <= 6; ++k) path.stations.emplace_back(0, 0, -depth * k * k / 36);
  const std::size_t pressed = path.stations.size() - 1;
  for (int k = 1; k <= 8; ++k) path.stations.emplace_back(0.08 * k * depth, 0, -depth);
  const std::size_t slid = path.stations.size() - 1;
  for (int k = 1; k <= 10; ++k) path.stations.emplace_back((0.64 - 0.12 * k) * depth, 0, -depth);
  const std::size_t turned = path.stations.size() - 1;
  for (int k = 5; k >= 0; --k) path.stations.emplace_back(-0.56 * depth, 0, k > 0 ? -depth * k * k / 36 : 0.1 * depth);

  const StrokeResult r = stroke();
  ASSERT_TRUE(r.usable) << r.cause;
  ASSERT_EQ(r.steps.size(), path.stations.size());
  const double hertz = 4.0 / 3 * 5e3 / (1 - 0.49 * 0.49) * std::sqrt(sphere.radius) * std::pow(depth, 1.5);
  EXPECT_NEAR(r.steps[pressed].force.z() / hertz, 1.03, 0.03);  // a block of 15 radii adds 2 %, friction 1 %
  EXPECT_FALSE(r.steps[pressed + 1].gross);
  // Mindlin: 1 - (1 - x)^1.5 of the limit at x of the way on which all of it comes to slip.
  EXPECT_NEAR(-r.steps[pressed + 1].force.x() / (path.friction * hertz), 0.25, 0.04);
  for (const std::size_t k : {slid, turned}) {
    EXPECT_TRUE(r.steps[k].gross);
    EXPECT_NEAR(r.steps[k].force.x() / r.steps[k].force.z() / path.friction, k == slid ? -1.0 : 1.0, 0.02);
  }
  EXPECT_EQ(r.steps.front().points, 0U);
  EXPECT_EQ(r.steps.back().points, 0U);
  EXPECT_EQ(r.steps.back().force, Vector3d::Zero());
  EXPECT_LT(std::abs(r.imbalance), 0.05);
  double last = 0;
  for (const StrokeStep& s : r.steps) {
    EXPECT_GE(s.dissipated, last);
    last = s.dissipated;
  }
}

// A hand holds the tool sideways and trembles up and down. Points that a lift releases carry no traction when the next
// push touches them again, so the force is lost once.
TEST_F(Stroking, ATremblingHandLosesItsTangentialForceOnce) {
  path.friction = 1;
  path.stations = {{0, 0, 0.1 * depth}};
  for (int k = 1; k <= 4; ++k) path.stations.emplace_back(0, 0, -depth * k * k / 16);
  const double aside = 0.3 * depth;
  for (const double share : {0.5, 1.0}) path.stations.emplace_back(share * aside, 0, -depth);
  const std::size_t held = path.stations.size() - 1;
  constexpr double kTurn = 0.64;  // of the depth: where the contact's radius is 0.8 of its own
  for (int cycle = 0; cycle < 3; ++cycle) {
    for (const double share : {0.82, kTurn, 0.82, 1.0}) path.stations.emplace_back(aside, 0, -share * depth);
  }
  const StrokeResult r = stroke();
  ASSERT_TRUE(r.usable) << r.cause;
  const auto force = [&](int cycle) { return -r.steps[held + 4 * static_cast<std::size_t>(cycle)].force.x(); };
  // The tangential stiffness grows like the radius, and what slips at the rim is lost besides.
  EXPECT_LT(force(1), 0.85 * force(0));
  EXPECT_GT(force(1), 0.7 * force(0));
  EXPECT_NEAR(force(2), force(1), 0.02 * force(1));
  EXPECT_NEAR(force(3), force(1), 0.03 * force(1));
  EXPECT_LT(std::abs(r.imbalance), 0.05);
}

TEST_F(Stroking, OutOfRangePathsAreRefused) {
  EXPECT_THROW(stroke(), Error) << "no station";
  path.stations = {{0, 0, depth}};
  EXPECT_THROW(stroke(), Error) << "none in contact";
  path.stations = {{0, std::numeric_limits<double>::quiet_NaN(), -depth}};
  EXPECT_THROW(stroke(), Error);
  path.stations = {{0, 0, -depth}};
  path.friction = 0;
  EXPECT_THROW(stroke(), Error);
}

}  // namespace
}  // namespace palpate::solve
