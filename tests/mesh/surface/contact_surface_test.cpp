// SPDX-License-Identifier: GPL-3.0-or-later
// Contact surfaces of a ball, a block, a wafer, a ring and a thin lens: closed, without crossings, within the
// tolerance, in few triangles, and with weights that agree along edges and follow the patches.
#include "precompute/mesh/surface/contact_surface.hpp"

#include "precompute/geometry/intersections.hpp"
#include "precompute/geometry/query.hpp"
#include "precompute/mesh/surface/patch_layout.hpp"
#include "precompute/mesh/surface/remesh.hpp"
#include "precompute/sites/haptic_mesh.hpp"
#include "tests/mesh/bodies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;

sites::HapticMesh haptic_mesh(const Surface& surface, double spacing) {
  Scene scene;
  scene.sampling.spacing = spacing;
  scene.sampling.depth = spacing / 5;
  return sites::make_haptic_mesh(scene, test::body_of(surface, spacing / 2));
}

Surface surface_of(const ContactSurface& c) {
  Surface s;
  s.vertices = c.points;
  for (const ContactTriangle& t : c.triangles) s.triangles.push_back(t.vertices);
  test::set_one_part(s, "contact");
  return s;
}

// A ball that is flattened along z.
Surface lens(double radius, double flattening) {
  Surface s = test::sphere_surface({0, 0, 0}, radius, 4);
  for (Vector3d& v : s.vertices) v.z() *= flattening;
  return s;
}

Surface ring(double radius, double thickness, int around, int across) {
  Surface s;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
      const double r = radius + thickness * std::cos(b);
      s.vertices.emplace_back(r * std::cos(a), r * std::sin(a), thickness * std::sin(b));
      const int i1 = (i + 1) % around, j1 = (j + 1) % across;
      s.triangles.push_back({i * across + j, i1 * across + j, i1 * across + j1});
      s.triangles.push_back({i * across + j, i1 * across + j1, i * across + j1});
    }
  }
  test::set_one_part(s, "ring");
  return s;
}

// Properties of every contact surface that follows its body.
void expect_sound(const ContactSurface& c, const Surface& body, const sites::HapticMesh& mesh, double tolerance) {
  const Surface s = surface_of(c);
  EXPECT_TRUE(c.fault.empty()) << c.fault;
  EXPECT_TRUE(test::closed_and_oriented(s));
  EXPECT_TRUE(geometry::crossing_triangles(s).empty());
  EXPECT_LE(c.distance, tolerance);
  const geometry::SurfaceQuery of_body(body), of_contact(s);
  for (const Vector3d& v : body.vertices) EXPECT_LE(of_contact.closest(v).distance, tolerance);
  for (const Vector3d& v : s.vertices) EXPECT_LE(of_body.closest(v).distance, tolerance);

  // Corners of one point give the same weights to the same sites.
  std::map<std::int32_t, std::map<std::int32_t, int>> first_seen;
  std::set<std::int32_t> patches;
  for (const ContactTriangle& t : c.triangles) {
    patches.insert(t.patch);
    for (int k = 0; k < 3; ++k) {
      const int whole[] = {t.grid[k][0], t.grid[k][1], c.weight_steps - t.grid[k][0] - t.grid[k][1]};
      std::map<std::int32_t, int> here;
      for (int i = 0; i < 3; ++i) {
        ASSERT_GE(whole[i], 0);
        if (whole[i] > 0) here[mesh.triangles[std::size_t(t.patch)][i]] = whole[i];
      }
      const auto seen = first_seen.try_emplace(t.vertices[k], here).first;
      EXPECT_EQ(seen->second, here) << "point " << t.vertices[k];
    }
  }
  EXPECT_EQ(patches.size(), mesh.triangles.size()) << "every patch is there";
}

// Largest distance, in spacings, of a point from the blend of its patch's sites.
double largest_offset(const ContactSurface& c, const sites::HapticMesh& mesh, double spacing) {
  double largest = 0;
  for (const ContactTriangle& t : c.triangles) {
    const auto& patch = mesh.triangles[std::size_t(t.patch)];
    for (int k = 0; k < 3; ++k) {
      const double u = 1.0 * t.grid[k][0] / c.weight_steps, v = 1.0 * t.grid[k][1] / c.weight_steps;
      const Vector3d flat = u * mesh.points[patch[0]] + v * mesh.points[patch[1]] + (1 - u - v) * mesh.points[patch[2]];
      largest = std::max(largest, (c.points[std::size_t(t.vertices[k])] - flat).norm() / spacing);
    }
  }
  return largest;
}

TEST(ContactSurface, BallStaysWithinTheToleranceInFewTriangles) {
  const Surface ball = test::sphere_surface({0, 0, 0}, 0.05, 4);
  const sites::HapticMesh mesh = haptic_mesh(ball, 0.015);
  const ContactSurface c = make_contact_surface(ball, mesh.points, mesh.triangles, 4e-4);
  expect_sound(c, ball, mesh, 4e-4);
  EXPECT_LT(c.triangles.size(), ball.triangles.size() / 5);
  EXPECT_LT(largest_offset(c, mesh, 0.015), 0.1);
  const ContactSurface fine = make_contact_surface(ball, mesh.points, mesh.triangles, 8e-5);
  expect_sound(fine, ball, mesh, 8e-5);
  EXPECT_GT(fine.triangles.size(), 2 * c.triangles.size()) << "the number goes with the inverse of the tolerance";
}

TEST(ContactSurface, BlockKeepsItsEdgesAndVolume) {
  const Surface block = test::box_surface({-0.025, -0.025, -0.025}, {0.025, 0.025, 0});
  const sites::HapticMesh mesh = haptic_mesh(block, 0.01);
  const ContactSurface c = make_contact_surface(block, mesh.points, mesh.triangles, 1e-4);
  expect_sound(c, block, mesh, 1e-4);
  EXPECT_NEAR(test::surface_volume(surface_of(c)) / (0.05 * 0.05 * 0.025), 1, 0.01);
  EXPECT_LT(c.triangles.size(), 2.5 * static_cast<double>(mesh.triangles.size())) << "flat patches need one each";
}

// Patches of a sharp margin lie across it. The surface does not fold there.
TEST(ContactSurface, SharpMarginIsNotCutOff) {
  const Surface body = lens(0.05, 0.08);
  const sites::HapticMesh mesh = haptic_mesh(body, 0.015);
  const ContactSurface c = make_contact_surface(body, mesh.points, mesh.triangles, 1e-4);
  expect_sound(c, body, mesh, 1e-4);
}

TEST(ContactSurface, BodyWithAHoleHasPatchesToo) {
  const Surface body = ring(0.04, 0.015, 60, 24);
  const sites::HapticMesh mesh = haptic_mesh(body, 0.012);
  const ContactSurface c = make_contact_surface(body, mesh.points, mesh.triangles, 1e-4);
  expect_sound(c, body, mesh, 1e-4);
}

TEST(ContactSurface, SeparatePartsAreAllThere) {
  Surface both = test::sphere_surface({0, 0, 0}, 0.04, 4);
  const Surface wafer = test::box_surface({0.1, -0.01, 0}, {0.12, 0.01, 0.001}, 4);
  const auto first = static_cast<std::int32_t>(both.vertices.size());
  both.vertices.insert(both.vertices.end(), wafer.vertices.begin(), wafer.vertices.end());
  for (const auto& t : wafer.triangles) both.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  test::set_one_part(both, "both");
  const sites::HapticMesh mesh = haptic_mesh(both, 0.012);
  const ContactSurface c = make_contact_surface(both, mesh.points, mesh.triangles, 1e-4);
  expect_sound(c, both, mesh, 1e-4);
}

// A mesh of a ball's patches on a ring: no path goes round both ways.
TEST(ContactSurface, PatchesOfAnotherTopologyStandForThemselves) {
  const Surface ball = test::sphere_surface({0, 0, 0}, 0.055, 4), body = ring(0.04, 0.015, 60, 24);
  const sites::HapticMesh mesh = haptic_mesh(ball, 0.02);
  const geometry::SurfaceQuery query(body);
  std::vector<Vector3d> sites;
  for (const Vector3d& p : mesh.points) sites.push_back(query.closest(p).point);
  try {
    const ContactSurface c = make_contact_surface(body, sites, mesh.triangles, 1e-4);
    EXPECT_NE(c.fault.find("contact surface:"), std::string::npos) << c.fault;
    EXPECT_EQ(c.triangles.size(), mesh.triangles.size());
    EXPECT_GT(c.distance, 1e-3) << "stated as it is";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::numerical) << "where that mesh crosses itself it is refused";
  }
}

// Triangles are thin and patches of several sizes: where only the shorter edges of a triangle are too long, it would be
// cut without end.
TEST(ContactSurface, ThinTrianglesBesideSmallPatchesAreCutToFew) {
  Surface thin = ring(0.03, 0.012, 5, 40);
  for (std::size_t v = 1; v < thin.vertices.size(); v += 2) {
    thin.vertices[v] = Eigen::AngleAxisd(0.12 * std::numbers::pi, Vector3d::UnitZ()) * thin.vertices[v];
  }
  const geometry::SurfaceQuery query(thin);
  const Surface coarse = remesh_uniform(thin, 0.02);
  std::vector<Vector3d> sites;
  for (const Vector3d& v : coarse.vertices) sites.push_back(query.closest(v).point);
  auto patches = coarse.triangles;
  for (std::size_t n = 0; n < 60; ++n) {
    auto& cut = patches[n * 7919 % patches.size()];
    const auto [a, b, c] = cut;
    const auto middle = static_cast<std::int32_t>(sites.size());
    sites.push_back(query.closest((sites[a] + sites[b] + sites[c]) / 3).point);
    cut = {a, b, middle};
    patches.push_back({b, c, middle});
    patches.push_back({c, a, middle});
  }
  const PatchLayout layout = lay_out_patches(thin, sites, patches);
  EXPECT_LT(layout.triangles.size(), 100000);
  const std::set<std::int32_t> found(layout.patch.begin(), layout.patch.end());
  EXPECT_EQ(found.size(), patches.size());
}

TEST(ContactSurface, SameSurfaceEveryTime) {
  const Surface ball = test::sphere_surface({0, 0, 0}, 0.05, 4);
  const sites::HapticMesh mesh = haptic_mesh(ball, 0.02);
  const ContactSurface a = make_contact_surface(ball, mesh.points, mesh.triangles, 1e-4);
  const ContactSurface b = make_contact_surface(ball, mesh.points, mesh.triangles, 1e-4);
  EXPECT_EQ(a.points, b.points);
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  for (std::size_t t = 0; t < a.triangles.size(); ++t) {
    EXPECT_EQ(a.triangles[t].vertices, b.triangles[t].vertices);
    EXPECT_EQ(a.triangles[t].grid, b.triangles[t].grid);
  }
}

}  // namespace
}  // namespace palpate::mesh
