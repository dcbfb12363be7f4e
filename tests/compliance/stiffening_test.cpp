// SPDX-License-Identifier: GPL-3.0-or-later
// By how much two deep tools on a thin block lose less to each other than dents in proportion to forces say.
#include "precompute/compliance/stiffening.hpp"

#include "tests/support/bodies.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace palpate::compliance {
namespace {

constexpr double kThin = 0.01, kHalf = 0.02, kRadius = 0.005, kDepth = 0.005;  // m

// A lobe of 2 kHalf x 2 kHalf x kThin with its top in z = 0, held at the bottom.
Body lobe() {
  Body body = test::block_body(kThin, 5e3, 0.49);
  const Surface surface = test::box_surface({-kHalf, -kHalf, -kThin}, {kHalf, kHalf, 0});
  body.query = std::make_shared<const geometry::SurfaceQuery>(surface);
  body.base = mesh::remesh_uniform(surface, body.base_size);
  body.diagonal = 3 * kHalf;
  return body;
}

// Two sites on the top near an edge, and one on the bottom.
ComplianceSites two_sites(double apart) {
  ComplianceSites sites;
  const double y = kHalf - 0.004;
  sites.places = {{{-0.5 * apart, y, 0}, {0, 0, 1}}, {{0.5 * apart, y, 0}, {0, 0, 1}}, {{0, 0, -kThin}, {0, 0, -1}}};
  sites.touchable = {1, 1, 0};
  sites.triangles = {{0, 1, 2}};
  return sites;
}

StiffeningReport measure(double apart) {
  const Body body = lobe();
  const ComplianceSites sites = two_sites(apart);
  ToolScene scene;
  scene.radius = kRadius;
  const tool::Tool tool = tool::make_tool(scene);
  return measure_stiffening(body, sites, {tool, tool.vertices[0], {kDepth, kDepth, 0}}, kDepth, {});
}

TEST(Stiffening, ThinTissueUnderDeepToolsIsStiffer) {
  const StiffeningReport report = measure(1.26 * kRadius);
  ASSERT_EQ(report.pairs, 1U) << report.cause;
  EXPECT_TRUE(report.cause.empty());
  EXPECT_GT(report.stiffening, 0.05);
  EXPECT_LT(report.stiffening, 0.8);
  EXPECT_LT(report.error, 0.03);
  EXPECT_GT(report.error_without, 2 * report.error);
}

TEST(Stiffening, SitesTooFarApartAreSaidToBe) {
  const StiffeningReport report = measure(1.8 * kHalf);
  EXPECT_EQ(report.pairs, 0U);
  EXPECT_EQ(report.stiffening, 0);
  EXPECT_NE(report.cause.find("no two sites"), std::string::npos) << report.cause;
}

}  // namespace
}  // namespace palpate::compliance
