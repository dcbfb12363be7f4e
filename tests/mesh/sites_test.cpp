// SPDX-License-Identifier: GPL-3.0-or-later
// Sites of a ball, a block and a plate: spacing, frames and depths.
#include "precompute/sites/haptic_mesh.hpp"

#include "formats/io/error.hpp"
#include "tests/mesh/bodies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;

Scene scene_with(double spacing, double depth) {
  Scene scene;
  scene.sampling.spacing = spacing;
  scene.sampling.depth = depth;
  return scene;
}

void expect_sound(const sites::HapticMesh& m, const Body& body) {
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
}

// Off the surface, outside the box and in a part too thin for the depth.
TEST(Sites, GivenPlacesAreSitesOfExactlyTheDepth) {
  const Body plate = test::body_of(test::box_surface({-0.05, -0.05, -0.006}, {0.05, 0.05, 0}), 0.01);
  Scene scene = scene_with(0.02, 0.005);
  scene.sampling.within_box = std::pair{Vector3d(0.02, 0.02, -1), Vector3d(1, 1, 1)};
  scene.sampling.sites = {{-0.0131, 0.0072, 0.001}, {0.003, -0.0191, 0}};
  const sites::HapticMesh m = sites::make_haptic_mesh(scene, plate);
  expect_sound(m, plate);
  for (const Vector3d& site : scene.sampling.sites) {
    const Vector3d on(site.x(), site.y(), 0);
    const auto at =
        std::find_if(m.points.begin(), m.points.end(), [&](const Vector3d& p) { return (p - on).norm() < 1e-9; });
    ASSERT_NE(at, m.points.end()) << site.transpose();
    const auto k = std::size_t(at - m.points.begin());
    EXPECT_EQ(m.depth[k], 0.005);
    EXPECT_EQ(m.selected[k], 1);
  }
  for (std::size_t k = 0; k < m.points.size(); ++k) EXPECT_LE(m.depth[k], 0.005);
  scene.sampling.sites = {{0, 0, 0.0051}};
  try {
    sites::make_haptic_mesh(scene, plate);
    FAIL() << "a site far off the surface was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_NE(std::string(error.what()).find("5.1 mm away from the body's surface"), std::string::npos) << error.what();
  }
}

TEST(Sites, BallHasEvenSpacingAndRadialNormals) {
  const Body ball = test::body_of(test::sphere_surface({0, 0, 0}, 0.05, 5), 0.006);
  Scene scene = scene_with(0.015, 0.005);
  scene.sampling.margin_spacing = 0.015;
  const sites::HapticMesh m = sites::make_haptic_mesh(scene, ball);
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
}

TEST(Sites, ThinPlateIsSampledFinerAndShallower) {
  const Body plate = test::body_of(test::box_surface({0, 0, 0}, {0.1, 0.1, 0.006}, 10), 0.006);
  const sites::HapticMesh m = sites::make_haptic_mesh(scene_with(0.02, 0.005), plate);
  expect_sound(m, plate);
  EXPECT_LT(m.edges.median, 0.014) << "half the spacing, for 6 mm is thinner than 1.5 spacings";
  for (std::size_t k = 0; k < m.points.size(); ++k) {
    EXPECT_LE(m.depth[k], 0.005);
    if (std::abs(m.normals[k].z()) > 0.99) {
      EXPECT_NEAR(m.depth[k], 0.6 * 0.006, 1e-5);
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
  const sites::HapticMesh m = sites::make_haptic_mesh(scene, block);
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

TEST(Sites, SplitEdgesKeepTheMeshConformingAndItsSites) {
  const Body block = test::block_body(0.01);
  Scene scene = scene_with(0.03, 0.002);
  sites::HapticMesh m = sites::make_haptic_mesh(scene, block);
  const sites::HapticMesh before = m;
  const auto least_angle = [](const sites::HapticMesh& mesh) {
    double least = 4;
    for (const auto& t : mesh.triangles) {
      for (int k = 0; k < 3; ++k) {
        const Vector3d a = mesh.points[t[(k + 1) % 3]] - mesh.points[t[k]],
                       b = mesh.points[t[(k + 2) % 3]] - mesh.points[t[k]];
        least = std::min(least, std::acos(a.normalized().dot(b.normalized())));
      }
    }
    return least;
  };
  for (int round = 0; round < 4; ++round) {  // again and again the edges round one site
    std::vector<sites::SiteEdge> edges;
    for (const auto& t : m.triangles) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t a = std::min(t[k], t[(k + 1) % 3]), b = std::max(t[k], t[(k + 1) % 3]);
        if (a == 0) edges.push_back({a, b});
      }
    }
    sites::split_edges(scene, block, edges, m);
  }
  EXPECT_GT(m.points.size(), before.points.size() + 10);
  for (std::size_t k = 0; k < before.points.size(); ++k) EXPECT_EQ(m.points[k], before.points[k]);
  EXPECT_GT(least_angle(m), 0.4 * least_angle(before));
  EXPECT_EQ(m.triangles.size(), 2 * m.points.size() - 4);  // closed, of genus 0
}

TEST(Sites, SameSitesEveryTime) {
  const Body ball = test::body_of(test::sphere_surface({0, 0, 0}, 0.05, 4), 0.006);
  const Scene scene = scene_with(0.012, 0.004);
  const sites::HapticMesh a = sites::make_haptic_mesh(scene, ball), b = sites::make_haptic_mesh(scene, ball);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.triangles, b.triangles);
}

}  // namespace
}  // namespace palpate::mesh
