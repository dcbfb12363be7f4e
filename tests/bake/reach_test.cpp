// SPDX-License-Identifier: GPL-3.0-or-later
// Which sites a tool can touch first.
#include "precompute/bake/reach.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace palpate::bake {
namespace {

// Strip in y with the profile of a flat top and a V-shaped groove at x = 0, `half_width` wide to either side.
Body grooved(double half_width) {
  const double profile[][2] = {{-0.03, 0}, {-half_width, 0}, {0, -0.01}, {half_width, 0}, {0.03, 0}};
  Surface s;
  s.part_names = {"strip"};
  for (const auto& p : profile) {
    s.vertices.emplace_back(p[0], -0.03, p[1]);
    s.vertices.emplace_back(p[0], 0.03, p[1]);
  }
  for (int k = 0; k < 4; ++k) {
    s.triangles.push_back({2 * k, 2 * k + 2, 2 * k + 3});
    s.triangles.push_back({2 * k, 2 * k + 3, 2 * k + 1});
  }
  s.parts.assign(s.triangles.size(), 0);
  Body body;
  body.query = std::make_shared<const geometry::SurfaceQuery>(s);
  return body;
}

TEST(Reach, AToolMeetsTheWallsOfANarrowFoldFirst) {
  ToolScene scene;
  scene.radius = 0.005;
  const tool::Tool tool = tool::make_tool(scene);
  ContactFrame bottom, top;
  bottom.origin = {0, 0, -0.01};
  top.origin = {0.02, 0, 0};

  const Body narrow = grooved(0.003);
  EXPECT_NEAR(touch_reach({narrow, tool, tool.vertices[0], top}).overlap, 0.0, 1e-9);
  EXPECT_TRUE(can_touch_first({narrow, tool, tool.vertices[0], top}));
  // Distance of the ball's centre (5 mm above the bottom) to a wall of slope 10 : 3 is 1.437 mm.
  EXPECT_NEAR(touch_reach({narrow, tool, tool.vertices[0], bottom}).overlap, 0.005 - 0.001437, 2e-4);
  EXPECT_FALSE(can_touch_first({narrow, tool, tool.vertices[0], bottom}));

  // A wide groove of slope 10 : 28 keeps the wall 4.7 mm from the centre: the bottom is touched.
  EXPECT_TRUE(can_touch_first({grooved(0.028), tool, tool.vertices[0], bottom}));
}

// Ledges over the flat top: one that the tool just rubs lets it out, a second above it does not.
TEST(Reach, AWallInTheWayBlocksTheTool) {
  ToolScene scene;
  scene.radius = 0.005;
  const tool::Tool tool = tool::make_tool(scene);
  ContactFrame top;
  top.origin = {0.02, 0, 0};
  Surface s = grooved(0.003).query->surface();
  Body body;
  for (const double height : {0.0095, 0.015}) {
    const auto n = static_cast<std::int32_t>(s.vertices.size());
    for (const double x : {0.01, 0.03}) {
      for (const double y : {-0.01, 0.01}) s.vertices.emplace_back(x, y, height);
    }
    s.triangles.push_back({n, n + 1, n + 2});
    s.triangles.push_back({n + 1, n + 3, n + 2});
    s.parts.assign(s.triangles.size(), 0);
    body.query = std::make_shared<const geometry::SurfaceQuery>(s);
    const TouchReach reach = touch_reach({body, tool, tool.vertices[0], top});
    EXPECT_NEAR(reach.overlap, 0.0005, 1e-5) << height;
    EXPECT_EQ(reach.blocked, height > 0.01) << height;
    EXPECT_EQ(can_touch_first({body, tool, tool.vertices[0], top}), height < 0.01) << height;
  }
}

TEST(Reach, SupportsUnderTheFootprintCount) {
  Body body = grooved(0.003);
  SupportScene support;
  support.kind = SupportScene::Kind::half_space;
  support.point = {-0.02, 0, 0};
  support.normal = {1, 0, 0};
  body.supports.push_back(support);
  body.support_surfaces.emplace_back();
  ToolScene scene;
  scene.radius = 0.005;
  const tool::Tool tool = tool::make_tool(scene);
  ContactFrame near_support, clear;
  near_support.origin = {-0.017, 0, 0};
  clear.origin = {-0.012, 0, 0};
  EXPECT_TRUE(reaches_support({body, tool, tool.vertices[0], near_support}, 0.0032));
  EXPECT_FALSE(reaches_support({body, tool, tool.vertices[0], near_support}, 0.0008));
  EXPECT_FALSE(reaches_support({body, tool, tool.vertices[0], clear}, 0.0032));

  // The end of a stem that lies on the body sinks into what is held 8 mm away.
  scene.shape = ToolScene::Shape::capsule;
  scene.radius = 0.004;
  scene.length = 0.012;
  scene.whole = true;
  const tool::Tool stem = tool::make_tool(scene);
  EXPECT_FALSE(reaches_support({body, stem, stem.vertices.front(), clear}, 0.002)) << "the tip";
  EXPECT_TRUE(reaches_support({body, stem, stem.vertices[stem.vertices.size() - 2], clear}, 0.002))
      << "the stem's middle";
}

}  // namespace
}  // namespace palpate::bake
