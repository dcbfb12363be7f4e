// SPDX-License-Identifier: GPL-3.0-or-later
// Plans of a slab: order, footprints that reach a support, regions, hashes of the inputs.
#include "precompute/bake/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <tuple>

#include "formats/io/error.hpp"
#include "formats/scene/scene.hpp"
#include "precompute/common/body.hpp"
#include "precompute/sites/haptic_mesh.hpp"
#include "precompute/tool/tool.hpp"

namespace palpate::test {
namespace {

using Eigen::Vector3d;

/// The slab [0, 0.1] x [0, 0.1] x [0, 0.02] (m).
Surface slab() {
  Surface s;
  for (int k = 0; k < 8; ++k) s.vertices.emplace_back(0.1 * (k & 1), 0.1 * ((k >> 1) & 1), 0.02 * ((k >> 2) & 1));
  s.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  s.parts.assign(12, 0);
  s.part_names = {"slab"};
  return s;
}

class SlabPlan : public testing::Test {
protected:
  SlabPlan() {
    scene_.file = "slab.toml";
    // Held: the top within 20 mm of the left side.
    SupportScene support;
    support.kind = SupportScene::Kind::box;
    support.box_min = {-1, -1, -1};
    support.box_max = {0.02, 1, 1};
    body_.supports = {support};
    body_.support_surfaces.resize(1);
    body_.query = std::make_shared<geometry::SurfaceQuery>(slab());
    for (const double x : {0.010, 0.022, 0.024, 0.0251, 0.030, 0.050}) {
      mesh_.points.emplace_back(x, 0.05, 0.02);
      mesh_.normals.emplace_back(0, 0, 1);
      mesh_.tangents.emplace_back(1, 0, 0);
      mesh_.thickness.push_back(0.02);
      mesh_.depth.push_back(0.005);
      mesh_.held.push_back(x < 0.02);
      mesh_.selected.push_back(1);
    }
    mesh_.triangles = {{0, 1, 2}, {3, 4, 5}};
    ToolScene sphere;
    sphere.radius = 0.005;
    tools_ = {tool::make_tool(sphere)};
  }

  Scene scene_;
  Body body_;
  sites::HapticMesh mesh_;
  std::vector<tool::Tool> tools_;
};

TEST_F(SlabPlan, FootprintsThatReachASupportAreSkipped) {
  const bake::Plan plan = bake::make_plan(scene_, body_, mesh_, tools_);
  // Contact radius at full depth: 5 mm. Sites 0 (held), 1 and 2 (2 and 4 mm away) are untouchable.
  ASSERT_EQ(plan.pairs.size(), 3U);
  EXPECT_EQ(plan.pairs[0].site, 3U);
  EXPECT_EQ(plan.pairs[2].site, 5U);
  ASSERT_EQ(plan.skipped.size(), 3U);
  for (const bake::SkippedPair& pair : plan.skipped) EXPECT_EQ(pair.reason, bake::SkipReason::support);
  // A shallower push has a smaller footprint: sqrt(5 mm x 0.5 mm) = 1.6 mm.
  for (double& depth : mesh_.depth) depth = 0.0005;
  EXPECT_EQ(bake::make_plan(scene_, body_, mesh_, tools_).pairs.size(), 5U);
}

TEST_F(SlabPlan, FramesAndDepthsAreTheMeshs) {
  mesh_.depth[4] = 0.003;
  const bake::Plan plan = bake::make_plan(scene_, body_, mesh_, tools_);
  const PairPlan& pair = plan.pairs[1];
  EXPECT_EQ(pair.site, 4U);
  EXPECT_EQ(pair.depth, 0.003);
  EXPECT_EQ(pair.frame.origin, mesh_.points[4]);
  EXPECT_EQ(pair.frame.x.cross(pair.frame.y), pair.frame.n);
}

TEST_F(SlabPlan, SiteMajorOverToolsAndVertices) {
  ToolScene capsule;
  capsule.name = "capsule";
  capsule.shape = ToolScene::Shape::capsule;
  capsule.radius = 0.003;
  capsule.length = 0.006;  // laid down it ends before the held part
  tools_.push_back(tool::make_tool(capsule));
  const bake::Plan plan = bake::make_plan(scene_, body_, mesh_, tools_);
  const std::size_t vertices = tools_[1].vertices.size();
  EXPECT_EQ(plan.pairs.size() + plan.skipped.size(), 6 * (1 + vertices));
  for (std::size_t k = 1; k < plan.pairs.size(); ++k) {
    const PairPlan &a = plan.pairs[k - 1], &b = plan.pairs[k];
    EXPECT_LT(std::tuple(a.site, a.tool, a.tool_vertex), std::tuple(b.site, b.tool, b.tool_vertex));
  }
  // A smaller radius reaches less far: site 2 is free for the capsule (3 mm), not for the sphere.
  EXPECT_TRUE(
      std::any_of(plan.pairs.begin(), plan.pairs.end(), [](const PairPlan& p) { return p.site == 2 && p.tool == 1; }));
  EXPECT_TRUE(
      std::none_of(plan.pairs.begin(), plan.pairs.end(), [](const PairPlan& p) { return p.site == 2 && p.tool == 0; }));
}

TEST_F(SlabPlan, SitesOutsideTheRegionAreSkipped) {
  mesh_.selected[5] = 0;
  const bake::Plan plan = bake::make_plan(scene_, body_, mesh_, tools_);
  EXPECT_EQ(plan.pairs.size(), 2U);
  EXPECT_EQ(plan.skipped.back(), (bake::SkippedPair{5, 0, 0, bake::SkipReason::outside}));
}

TEST_F(SlabPlan, NothingToTouchIsAnError) {
  body_.supports[0].box_max = {1, 1, 1};
  try {
    bake::make_plan(scene_, body_, mesh_, tools_);
    FAIL() << "every site is held";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_NE(std::string(error.what()).find("slab.toml"), std::string::npos);
  }
}

TEST_F(SlabPlan, InputsAreHashed) {
  const bake::PlanInputs before = bake::make_plan(scene_, body_, mesh_, tools_).inputs;
  EXPECT_EQ(bake::make_plan(scene_, body_, mesh_, tools_).inputs, before);
  scene_.material.young *= 2;
  EXPECT_FALSE(bake::make_plan(scene_, body_, mesh_, tools_).inputs.scene == before.scene);
  mesh_.points[5].x() += 1e-12;
  EXPECT_FALSE(bake::make_plan(scene_, body_, mesh_, tools_).inputs.haptic_mesh == before.haptic_mesh);
  Surface moved = slab();
  moved.vertices[7].x() += 1e-9;
  body_.query = std::make_shared<geometry::SurfaceQuery>(moved);
  EXPECT_FALSE(bake::make_plan(scene_, body_, mesh_, tools_).inputs.body == before.body);
  tools_[0].vertices[0].curvature_radius *= 1.5;
  EXPECT_FALSE(bake::make_plan(scene_, body_, mesh_, tools_).inputs.tools == before.tools);
}

}  // namespace
}  // namespace palpate::test
