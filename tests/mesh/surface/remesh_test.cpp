// SPDX-License-Identifier: GPL-3.0-or-later
// Uniform remeshing: the coarse base of a body.
#include "precompute/mesh/surface/remesh.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/intersections.hpp"
#include "tests/support/shapes.hpp"

#include <gtest/gtest.h>

#include <set>

namespace palpate::mesh {
namespace {

double mean_edge(const Surface& s) {
  double sum = 0;
  for (const auto& t : s.triangles) {
    for (int k = 0; k < 3; ++k) sum += (s.vertices[t[k]] - s.vertices[t[(k + 1) % 3]]).norm();
  }
  return sum / (3.0 * static_cast<double>(s.triangles.size()));
}

TEST(Remesh, BallKeepsVolumeAndGetsItsEdgeLength) {
  const Surface fine = test::sphere_surface({0.1, 0, 0}, 0.05, 5);
  const Surface coarse = remesh_uniform(fine, 0.006);
  EXPECT_TRUE(test::closed_and_oriented(coarse));
  EXPECT_FALSE(geometry::self_intersects(coarse));
  EXPECT_NEAR(mean_edge(coarse) / 0.006, 1, 0.15);
  EXPECT_NEAR(test::surface_volume(coarse) / test::surface_volume(fine), 1, 0.01);
}

TEST(Remesh, BoxStaysABoxAndKeepsItsParts) {
  Surface box = test::box_surface({0, 0, 0}, {0.1, 0.06, 0.04}, 2);
  box.part_names = {"rest", "top"};
  for (std::size_t t = 0; t < box.triangles.size(); ++t) {
    const auto& c = box.triangles[t];
    box.parts[t] = box.vertices[c[0]].z() == 0.04 && box.vertices[c[1]].z() == 0.04 && box.vertices[c[2]].z() == 0.04;
  }
  const Surface coarse = remesh_uniform(box, 0.008);
  EXPECT_NEAR(test::surface_volume(coarse) / (0.1 * 0.06 * 0.04), 1, 1e-12);
  ASSERT_EQ(coarse.parts.size(), coarse.triangles.size());
  EXPECT_EQ(coarse.part_names, box.part_names);
  double top = 0;
  for (std::size_t t = 0; t < coarse.triangles.size(); ++t) {
    if (coarse.parts[t] != 1) continue;
    const auto& c = coarse.triangles[t];
    top +=
        (coarse.vertices[c[1]] - coarse.vertices[c[0]]).cross(coarse.vertices[c[2]] - coarse.vertices[c[0]]).norm() / 2;
  }
  EXPECT_NEAR(top, 0.1 * 0.06, 1e-12);
}

TEST(Remesh, ThinPlateCoarserThanItsThicknessStaysWhole) {
  const Surface plate = test::box_surface({0, 0, 0}, {0.1, 0.1, 0.002}, 6);
  const Surface coarse = remesh_uniform(plate, 0.02);
  EXPECT_TRUE(test::closed_and_oriented(coarse));
  EXPECT_FALSE(geometry::self_intersects(coarse));
  EXPECT_NEAR(test::surface_volume(coarse) / (0.1 * 0.1 * 0.002), 1, 1e-9);
}

TEST(Remesh, BadInputIsRefused) {
  const Surface ball = test::sphere_surface({0, 0, 0}, 0.05, 2);
  EXPECT_THROW(remesh_uniform(ball, 0.0), Error);
  Surface doubled = ball;
  doubled.triangles.push_back(doubled.triangles[0]);
  doubled.parts.push_back(0);
  EXPECT_THROW(remesh_uniform(doubled, 0.01), Error);
}

}  // namespace
}  // namespace palpate::mesh
