// SPDX-License-Identifier: GPL-3.0-or-later
// Elements round a contact follow the contact that the two shapes make, not the tool alone.
#include "precompute/solve/pair/contact_size.hpp"

#include "precompute/geometry/solids.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "tests/support/bodies.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;

class FlatPunch : public testing::Test {
protected:
  FlatPunch() {
    scene_.tools.resize(1);
    scene_.tools[0].shape = ToolScene::Shape::punch;
    scene_.tools[0].radius = radius_;
    scene_.tools[0].edge_radius = 0.1 * radius_;
    tool_ = tool::make_tool(scene_.tools[0]);
  }

  // Edge of the elements in contact radii of `radius`, at this share of it from the centre.
  double size_at(const Body& body, double radius, double share) const {
    const mesh::SizeField size =
        contact_size({body, tool_, tool_.vertices[0], ContactFrame{}}, depth_, 1.0, pair_options(scene_));
    return size({share * radius, 0, 0}) / radius;
  }

  static constexpr double radius_ = 0.01, depth_ = 2.5e-4;  // m
  Scene scene_;
  tool::Tool tool_;
};

TEST_F(FlatPunch, OnABallHasElementsOfTheSmallContact) {
  Body ball = test::block_body(radius_, 5e3, 0.49);
  const Vector3d centre(0, 0, -radius_);
  ball.query = std::make_shared<const geometry::SurfaceQuery>(
      geometry::ellipsoid(centre, Vector3d::Constant(radius_), 4e-4, "ball"));
  const double overlap = std::sqrt(2 * radius_ * depth_);
  const double mesh_size = pair_options(scene_).mesh_size;
  EXPECT_LT(size_at(ball, overlap, 0.5), 1.2 * mesh_size);
  EXPECT_LT(size_at(ball, overlap, 0.0), 0.3 * mesh_size);  // a point touches first
}

TEST_F(FlatPunch, OnAPlaneHasElementsOfItsOwnRadius) {
  const Body block = test::block_body(3 * radius_, 5e3, 0.49);
  const double flat = tool_.vertices[0].flat_radius;
  const double mesh_size = pair_options(scene_).mesh_size;
  EXPECT_NEAR(size_at(block, flat, 0.5), mesh_size, 0.2 * mesh_size);
  EXPECT_NEAR(size_at(block, flat, 0.0), mesh_size, 0.2 * mesh_size);
}

// Its box is wider than the body, and twenty thousand times as wide as what it covers.
TEST(Cone, HasElementsOfItsContactHoweverLongItIs) {
  ToolScene scene;
  scene.shape = ToolScene::Shape::cone;
  scene.radius = 1e-5;
  scene.half_angle = 1.2;
  scene.length = 0.1;
  const tool::Tool cone = tool::make_tool(scene);
  const Body block = test::block_body(0.03, 5e3, 0.49);
  const double depth = 5e-6, radius = tool::contact_radius(cone.vertices[0], depth);
  const PairOptions options = pair_options(Scene{});
  const mesh::SizeField size = contact_size({block, cone, cone.vertices[0], ContactFrame{}}, depth, 1.0, options);
  for (const double share : {0.4, 0.8}) {
    EXPECT_NEAR(size({share * radius, 0, 0}) / (options.mesh_size * radius), 1, 0.3) << share;
  }
}

}  // namespace
}  // namespace palpate::solve
