// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that cross themselves or each other, and near misses.
#include "precompute/geometry/intersections.hpp"

#include "formats/io/error.hpp"
#include "tests/support/shapes.hpp"
#include "tests/surface/faulty_shapes.hpp"

#include <gtest/gtest.h>

#include <set>

namespace palpate::geometry {
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

TEST(Intersections, PairsThatCross) {
  EXPECT_EQ(crossings(test::cube()).size(), 0U);
  EXPECT_GT(crossings(test::pierced()).size(), 5U);
  EXPECT_GT(crossings(test::overlapping()).size(), 10U);
  EXPECT_EQ(crossings(test::split_vertices(test::cube())).size() > 0, true)
      << "touching without sharing an index is meeting";
  // Two triangles over one edge that fold onto each other, and the same opened flat.
  Surface fold;
  fold.vertices = {{0, 0, 0}, {1, 0, 0}, {0.3, 1, 0}, {0.6, 0.7, 0}};
  fold.triangles = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_EQ(crossings(fold).size(), 1U);
  fold.vertices[3].y() = -0.7;
  EXPECT_EQ(crossings(fold).size(), 0U);
  // One shared corner: passing through or not.
  Surface pair;
  pair.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.2, -1}, {0.5, 0.2, 1}};
  pair.triangles = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_EQ(crossings(pair).size(), 1U);
  pair.vertices[3].z() = 0.5;
  EXPECT_EQ(crossings(pair).size(), 0U);
}

TEST(Intersections, PairsBetweenSurfaces) {
  EXPECT_GT(crossings(test::cube(), test::sphere_surface({0.2, 0.1, 0.1}, 0.05)), 0U);
  EXPECT_EQ(crossings(test::cube(), test::sphere_surface({0.1, 0.1, 0.1}, 0.05)), 0U);
  EXPECT_EQ(crossings(test::cube(), test::sphere_surface({0.5, 0.1, 0.1}, 0.05)), 0U);
}

TEST(Intersections, TrianglesThatCrossOrHaveNoArea) {
  Surface ball = test::sphere_surface({0, 0, 0}, 0.05, 3);
  EXPECT_TRUE(crossing_triangles(ball).empty());
  ball.vertices[0] = -1.5 * ball.vertices[0];
  std::set<std::int32_t> in_pairs;
  for (const auto& pair : crossings(ball)) in_pairs.insert(pair.begin(), pair.end());
  const std::vector<std::int32_t> found = crossing_triangles(ball);
  EXPECT_GT(found.size(), 5U);
  EXPECT_EQ(found, std::vector<std::int32_t>(in_pairs.begin(), in_pairs.end()));

  // The triangle of no area is the second of a pair that does not cross otherwise.
  Surface flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0, 0}};
  flat.triangles = {{0, 1, 2}, {0, 3, 1}};
  EXPECT_TRUE(crossings(flat).empty());
  EXPECT_EQ(crossing_triangles(flat), std::vector<std::int32_t>{1});
}

TEST(Intersections, BallsApartNestedAndCrossing) {
  const Surface ball = test::sphere_surface({0, 0, 0}, 0.05, 3);
  EXPECT_FALSE(surfaces_intersect(ball, test::sphere_surface({0.11, 0, 0}, 0.05, 3)));
  EXPECT_FALSE(surfaces_intersect(ball, test::sphere_surface({0, 0, 0}, 0.03, 2)));
  EXPECT_TRUE(surfaces_intersect(ball, test::sphere_surface({0.08, 0, 0}, 0.05, 3)));
}

}  // namespace
}  // namespace palpate::geometry
