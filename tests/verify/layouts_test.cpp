// SPDX-License-Identifier: GPL-3.0-or-later
// Layouts of tools on a block, and the places that are refused.
#include "precompute/verify/layouts.hpp"

#include "precompute/geometry/solids.hpp"
#include "precompute/verify/contact_checks.hpp"
#include "tests/support/bodies.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::verify {
namespace {

using Eigen::Vector3d;

LayoutOptions options(Layout layout, int count) {
  LayoutOptions o;
  o.layout = layout;
  o.count = count;
  o.spacing = 0.003;
  o.farthest = 0.012;
  o.aside = 1e-4;
  return o;
}

double apart(const Places& places, std::size_t a, std::size_t b) {
  return (places.frames[a].origin - places.frames[b].origin).norm();
}

class Layouts : public testing::Test {
protected:
  const Body body_ = test::block_body(0.03, 5e3, 0.49);  // its top lies in z = 0
};

TEST_F(Layouts, LineHasEvenSpacing) {
  const Places places = lay_out(body_, ContactFrame{}, options(Layout::line, 4));
  ASSERT_TRUE(places.cause.empty()) << places.cause;
  ASSERT_EQ(places.frames.size(), 4U);
  for (std::size_t k = 1; k < 4; ++k) EXPECT_NEAR(apart(places, k - 1, k), 0.003, 1e-9);
}

TEST_F(Layouts, RingHasItsNeighboursOneSpacingApart) {
  const Places places = lay_out(body_, ContactFrame{}, options(Layout::ring, 5));
  ASSERT_TRUE(places.cause.empty()) << places.cause;
  ASSERT_EQ(places.frames.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(apart(places, k, (k + 1) % 5), 0.003, 1e-9);
    EXPECT_GT(apart(places, k, (k + 2) % 5), 0.0045);
  }
}

TEST_F(Layouts, ToolsOnARoundBodyPressAlongItsNormals) {
  Body ball = test::block_body(0.03, 5e3, 0.49);
  const Eigen::Vector3d centre(0, 0, -0.03);
  ball.query = std::make_shared<const geometry::SurfaceQuery>(
      geometry::ellipsoid(centre, Vector3d::Constant(0.03), 4e-4, "ball"));
  LayoutOptions o = options(Layout::line, 3);
  o.aside = 1e-3;
  o.normal_radius = 1e-3;
  const Places places = lay_out(ball, ContactFrame{}, o);
  ASSERT_TRUE(places.cause.empty()) << places.cause;
  for (const ContactFrame& f : places.frames) {
    EXPECT_GT(f.n.dot((f.origin - centre).normalized()), std::cos(0.02));
    EXPECT_NEAR(f.n.dot(f.x.cross(f.y)), 1, 1e-9);
    EXPECT_NEAR(f.n.dot(f.x), 0, 1e-9);
  }
  EXPECT_GT(apart(places, 0, 2), 0.005);
}

TEST_F(Layouts, RandomPlacesKeepTheirDistanceAndDifferBySeed) {
  LayoutOptions o = options(Layout::random, 5);
  for (o.seed = 1; o.seed <= 20; ++o.seed) {
    const Places places = lay_out(body_, ContactFrame{}, o);
    ASSERT_TRUE(places.cause.empty()) << places.cause;
    for (std::size_t a = 0; a < 5; ++a) {
      for (std::size_t b = 0; b < a; ++b) EXPECT_GE(apart(places, a, b), 0.003 - 1e-9);
      EXPECT_LE(apart(places, a, 0), 0.012 + 1e-9);
    }
    const Places again = lay_out(body_, ContactFrame{}, o);
    EXPECT_EQ(places.frames[1].origin, again.frames[1].origin);
  }
}

TEST_F(Layouts, PinchLiesOnTheWallBehind) {
  // The bottom of this block is held.
  EXPECT_NE(lay_out(body_, ContactFrame{}, options(Layout::pinch, 2)).cause.find("held"), std::string::npos);
  ContactFrame side;
  side.origin = {0.03, 0, -0.01};
  side.n = Vector3d::UnitX();
  side.x = Vector3d::UnitY();
  side.y = Vector3d::UnitZ();
  const double width = body_.query->ray(side.origin, -side.n, 1e-6).value_or(0);
  const Places places = lay_out(body_, side, options(Layout::pinch, 2));
  ASSERT_TRUE(places.cause.empty()) << places.cause;
  EXPECT_NEAR(apart(places, 0, 1), width, 1e-9);
  EXPECT_EQ(places.frames[1].n, -side.n);
  EXPECT_NEAR(places.frames[1].x.cross(places.frames[1].y).dot(places.frames[1].n), 1, 1e-12);
}

TEST_F(Layouts, PlacesBeyondTheSurfaceAreRefusedByName) {
  LayoutOptions o = options(Layout::line, 2);
  o.spacing = 0.1;
  const Places places = lay_out(body_, ContactFrame{}, o);
  EXPECT_EQ(places.cause.rfind("place: the surface bends away or ends", 0), 0U) << places.cause;
}

// Nothing is solved: no direction has a place for the second tool.
TEST_F(Layouts, PlacesWithoutABakedResponseAreRefusedByName) {
  constexpr double kDepth = 1e-3;
  Scene scene;
  scene.tools.resize(1);
  const tool::Tool tool = tool::make_tool(scene.tools[0]);
  const auto cause = [&](const ContactCheckOptions& options) {
    const auto all = check_together(scene, body_, tool, {{ContactFrame{}, kDepth}}, options);
    EXPECT_FALSE(all.at(0).result.usable);
    return all.at(0).result.cause;
  };
  ContactCheckOptions options;
  options.spacings = {1.5};
  options.touchable = [](const solve::ContactCase&, double) { return false; };
  EXPECT_EQ(cause(options).rfind("place: at a support or in a fold", 0), 0U) << cause(options);
  scene.sampling.depth_fraction = 0.01;
  EXPECT_EQ(cause(options).rfind("place: sampling.depth_fraction ends at", 0), 0U) << cause(options);
  scene.sampling.within_box = {{Vector3d::Constant(-1e-4), Vector3d::Constant(1e-4)}};
  EXPECT_EQ(cause(options).rfind("place: outside sampling.within_box", 0), 0U) << cause(options);
}

}  // namespace
}  // namespace palpate::verify
