// SPDX-License-Identifier: GPL-3.0-or-later
// Sites of a ball, a block and a plate: spacing, frames, depths, and the fine contact surface.
#include "precompute/mesh/haptic_mesh.hpp"

#include "formats/error.hpp"
#include "tests/mesh/bodies.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>

namespace palpate {
namespace {

using Eigen::Vector3d;

Scene scene_with(double spacing, double depth) {
  Scene scene;
  scene.sampling.spacing = spacing;
  scene.sampling.depth = depth;
  return scene;
}

Surface fine_surface(const HapticMesh& m) {
  Surface s;
  s.vertices = m.fine_points;
  for (const FineTriangle& t : m.fine_triangles) s.triangles.push_back(t.vertices);
  test::set_one_part(s, "fine");
  return s;
}

void expect_sound(const HapticMesh& m, const Body& body) {
  const std::size_t n = m.points.size();
  for (const std::size_t size :
       {m.normals.size(), m.tangents.size(), m.thickness.size(), m.depth.size(), m.held.size(), m.selected.size()}) {
    ASSERT_EQ(size, n);
  }
  for (std::size_t k = 0; k < n; ++k) {
    EXPECT_LT(body.query->closest(m.points[k]).distance, 1e-12);
    EXPECT_NEAR(m.normals[k].norm(), 1, 1e-12);
    EXPECT_NEAR(m.tangents[k].norm(), 1, 1e-12);
    EXPECT_NEAR(m.tangents[k].dot(m.normals[k]), 0, 1e-12);
    EXPECT_GT(m.depth[k], 0);
  }
  Surface coarse;
  coarse.vertices = m.points;
  coarse.triangles = m.triangles;
  EXPECT_TRUE(test::closed_and_oriented(coarse));
  EXPECT_TRUE(test::closed_and_oriented(fine_surface(m)));
  const auto k2 = static_cast<std::size_t>(m.subdivision) * static_cast<std::size_t>(m.subdivision);
  EXPECT_EQ(m.fine_triangles.size(), m.triangles.size() * k2);
}

TEST(Sites, BallHasEvenSpacingAndRadialNormals) {
  const Body ball = test::body_of(test::sphere_surface({0, 0, 0}, 0.05, 5), 0.006);
  Scene scene = scene_with(0.015, 0.005);
  scene.sampling.margin_spacing = 0.015;
  const HapticMesh m = make_haptic_mesh(scene, ball);
  expect_sound(m, ball);
  EXPECT_NEAR(m.edges.mean / 0.015, 1, 0.15);
  EXPECT_GT(m.edges.shortest, 0.5 * 0.015);
  EXPECT_LT(m.edges.longest, 1.6 * 0.015);
  EXPECT_LE(m.edges.shortest, m.edges.median);
  for (std::size_t k = 0; k < m.points.size(); ++k) {
    EXPECT_GT(m.normals[k].dot(m.points[k].normalized()), 0.999);
    EXPECT_NEAR(m.thickness[k], 0.0966, 0.002);
    EXPECT_EQ(m.depth[k], 0.005);
    EXPECT_EQ(m.selected[k], 1);
  }
  // 15 mm patches on a 50 mm ball sag by about 0.37 mm in their middle: k^2 times less when subdivided.
  EXPECT_GE(m.subdivision, 2);
  EXPECT_LE(m.subdivision, 4);
  EXPECT_LE(m.chordal_error, 0.02 * 0.005);
}

TEST(Sites, FlatBlockNeedsNoSubdivision) {
  const Body block = test::block_body(0.005);
  const HapticMesh m = make_haptic_mesh(scene_with(0.01, 0.002), block);
  expect_sound(m, block);
  EXPECT_EQ(m.subdivision, 1);
  EXPECT_LT(m.chordal_error, 1e-12);
  EXPECT_EQ(m.fine_points, m.points);
  EXPECT_NEAR(test::surface_volume(fine_surface(m)) / (0.05 * 0.05 * 0.025), 1, 1e-12);
}

TEST(Sites, ThinPlateIsSampledFinerAndShallower) {
  const Body plate = test::body_of(test::box_surface({0, 0, 0}, {0.1, 0.1, 0.006}, 10), 0.006);
  const HapticMesh m = make_haptic_mesh(scene_with(0.02, 0.005), plate);
  expect_sound(m, plate);
  EXPECT_LT(m.edges.median, 0.014) << "half the spacing, for 6 mm is thinner than 1.5 spacings";
  for (std::size_t k = 0; k < m.points.size(); ++k) {
    EXPECT_LE(m.depth[k], 0.005);
    if (std::abs(m.normals[k].z()) > 0.99) {
      EXPECT_NEAR(m.depth[k], 0.6 * 0.006, 1e-5);
    }
  }
}

TEST(Sites, FinePointsCarryTheirPatchWeights) {
  const Body ball = test::body_of(test::sphere_surface({0, 0, 0}, 0.05, 5), 0.006);
  const HapticMesh m = make_haptic_mesh(scene_with(0.015, 0.003), ball);
  expect_sound(m, ball);
  const double k = m.subdivision;
  for (const FineTriangle& t : m.fine_triangles) {
    const auto& patch = m.triangles[t.patch];
    for (int c = 0; c < 3; ++c) {
      const double u = t.grid[c][0] / k, v = t.grid[c][1] / k;
      ASSERT_LE(u + v, 1 + 1e-12);
      const Vector3d flat = u * m.points[patch[0]] + v * m.points[patch[1]] + (1 - u - v) * m.points[patch[2]];
      EXPECT_LT((m.fine_points[t.vertices[c]] - flat).norm(), 0.002);
      EXPECT_LT(ball.query->closest(m.fine_points[t.vertices[c]]).distance, 1e-12);
    }
  }
}

TEST(Sites, BoxAndSupportsMarkSites) {
  Body block = test::block_body(0.005);
  SupportScene floor;
  floor.kind = SupportScene::Kind::half_space;
  floor.point = {0, 0, -0.0249};
  floor.normal = {0, 0, 1};
  block.supports.push_back(floor);
  block.support_surfaces.push_back(nullptr);
  Scene scene = scene_with(0.008, 0.002);
  scene.sampling.within_box = {{Vector3d(-1, -1, -0.001), Vector3d(0, 1, 1)}};
  const HapticMesh m = make_haptic_mesh(scene, block);
  int held = 0, selected = 0;
  for (std::size_t k = 0; k < m.points.size(); ++k) {
    EXPECT_EQ(m.held[k] != 0, m.points[k].z() <= -0.0249);
    EXPECT_EQ(m.selected[k] != 0, m.points[k].z() >= -0.001 && m.points[k].x() <= 0);
    held += m.held[k];
    selected += m.selected[k];
  }
  EXPECT_GT(held, 10);
  EXPECT_GT(selected, 10);
}

// A wafer beside a ball allows depths that would need the finest subdivision. It counts neither outside the box nor
// held, nor where it is a twentieth of the sites.
TEST(Sites, ShallowSitesThatAreFewOrUntouchedDoNotRefine) {
  Surface both = test::sphere_surface({0, 0, 0}, 0.1, 5);
  const Surface wafer = test::box_surface({0.2, -0.01, 0}, {0.22, 0.01, 0.0004}, 4);
  const auto first = static_cast<std::int32_t>(both.vertices.size());
  both.vertices.insert(both.vertices.end(), wafer.vertices.begin(), wafer.vertices.end());
  for (const auto& t : wafer.triangles) both.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  test::set_one_part(both, "both");
  Body body = test::body_of(both, 0.006);
  const auto on_wafer = [](const HapticMesh& m, std::size_t k) { return m.points[k].x() > 0.15; };

  Scene scene = scene_with(0.015, 0.005);
  const HapticMesh whole = make_haptic_mesh(scene, body);
  std::size_t shallow = 0;
  for (std::size_t k = 0; k < whole.points.size(); ++k) {
    // Its narrow sides are as thick as the wafer is wide.
    if (on_wafer(whole, k) && whole.depth[k] < 0.00025) ++shallow;
  }
  EXPECT_GT(shallow, 4U);
  EXPECT_LT(shallow, whole.points.size() / 20);
  EXPECT_LE(whole.subdivision, 3);

  // The wafer is more than a twentieth of the cap of the ball and the wafer together.
  scene.sampling.within_box = {{Vector3d(0.08, -1, -1), Vector3d(1, 1, 1)}};
  EXPECT_GT(make_haptic_mesh(scene, body).subdivision, 3);
  SupportScene clamp;
  clamp.kind = SupportScene::Kind::box;
  clamp.box_min = {0.15, -1, -1};
  clamp.box_max = {1, 1, 1};
  body.supports.push_back(clamp);
  body.support_surfaces.push_back(nullptr);
  EXPECT_LE(make_haptic_mesh(scene, body).subdivision, 3) << "held";
  scene.sampling.within_box = {{Vector3d(0.08, -1, -1), Vector3d(0.15, 1, 1)}};
  body.supports.clear();
  EXPECT_LE(make_haptic_mesh(scene, body).subdivision, 3) << "outside";
}

TEST(Sites, SameSitesEveryTime) {
  const Body ball = test::body_of(test::sphere_surface({0, 0, 0}, 0.05, 4), 0.006);
  const Scene scene = scene_with(0.012, 0.004);
  const HapticMesh a = make_haptic_mesh(scene, ball), b = make_haptic_mesh(scene, ball);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.fine_points, b.fine_points);
}

}  // namespace
}  // namespace palpate
