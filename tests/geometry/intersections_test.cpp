// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that cross themselves or each other, and near misses.
#include "precompute/geometry/intersections.hpp"

#include "formats/error.hpp"
#include "tests/support/shapes.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

using Eigen::Vector3d;

TEST(Intersections, CleanBallDoesNotCrossItself) {
  EXPECT_FALSE(self_intersects(test::sphere_surface({0, 0, 0}, 0.05, 3)));
}

TEST(Intersections, VertexPulledThroughTheFarWallIsFound) {
  Surface ball = test::sphere_surface({0, 0, 0}, 0.05, 3);
  ball.vertices[0] = -1.5 * ball.vertices[0];
  EXPECT_TRUE(self_intersects(ball));
}

TEST(Intersections, TriangleWithoutAreaIsFound) {
  Surface box = test::box_surface({0, 0, 0}, {1, 1, 1}, 2);
  box.vertices[box.triangles[0][1]] = (box.vertices[box.triangles[0][0]] + box.vertices[box.triangles[0][2]]) / 2;
  EXPECT_TRUE(self_intersects(box));
}

TEST(Intersections, NonManifoldSurfaceIsRefusedByName) {
  Surface box = test::box_surface({0, 0, 0}, {1, 1, 1});
  box.triangles.push_back(box.triangles[3]);
  try {
    self_intersects(box);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_NE(std::string(error.what()).find("triangle 12"), std::string::npos) << error.what();
  }
}

TEST(Intersections, BallsApartNestedAndCrossing) {
  const Surface ball = test::sphere_surface({0, 0, 0}, 0.05, 3);
  EXPECT_FALSE(surfaces_intersect(ball, test::sphere_surface({0.11, 0, 0}, 0.05, 3)));
  EXPECT_FALSE(surfaces_intersect(ball, test::sphere_surface({0, 0, 0}, 0.03, 2)));
  EXPECT_TRUE(surfaces_intersect(ball, test::sphere_surface({0.08, 0, 0}, 0.05, 3)));
}

}  // namespace
}  // namespace palpate
