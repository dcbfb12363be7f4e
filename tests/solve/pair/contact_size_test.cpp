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

}  // namespace
}  // namespace palpate::solve
