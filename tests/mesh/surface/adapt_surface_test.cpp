// SPDX-License-Identifier: GPL-3.0-or-later
// Adapted surfaces: shape kept, sizes followed, anchors hit, closed, not crossing, the same every time.
#include "precompute/mesh/surface/adapt_surface.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/intersections.hpp"
#include "precompute/geometry/solids.hpp"
#include "tests/mesh/bodies.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;

// Largest and smallest edge over the size field at its middle.
std::pair<double, double> relative_edges(const Surface& s, const SizeField& size) {
  double least = 1e9, most = 0;
  for (const auto& t : s.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vector3d &a = s.vertices[t[k]], &b = s.vertices[t[(k + 1) % 3]];
      const double relative = (a - b).norm() / size((a + b) / 2);
      least = std::min(least, relative);
      most = std::max(most, relative);
    }
  }
  return {least, most};
}

void expect_sound(const AdaptedSurface& adapted, const std::vector<Vector3d>& anchors) {
  EXPECT_TRUE(test::closed_and_oriented(adapted.surface));
  EXPECT_FALSE(geometry::self_intersects(adapted.surface));
  ASSERT_EQ(adapted.anchors.size(), anchors.size());
  for (std::size_t k = 0; k < anchors.size(); ++k) {
    EXPECT_EQ(adapted.surface.vertices[adapted.anchors[k]], anchors[k]);
  }
}

TEST(AdaptSurface, BoxStaysABox) {
  const Body block = test::block_body(0.005);
  for (const Vector3d& site : {Vector3d(0, 0, 0), Vector3d(0.021, -0.013, 0), Vector3d(0.025, 0.003, 0),
                               Vector3d(0.0249, 0.003, 0), Vector3d(0.025, 0.025, 0)}) {
    const SizeField size = test::size_round(site, 0.00175, 0.007);
    const AdaptedSurface a = adapt_surface(block.base, *block.query, size, {site});
    expect_sound(a, {site});
    EXPECT_NEAR(test::surface_volume(a.surface) / (0.05 * 0.05 * 0.025), 1, 1e-12);
    for (const Vector3d& v : a.surface.vertices) EXPECT_LT(block.query->closest(v).distance, 1e-15);
    const auto [least, most] = relative_edges(a.surface, size);
    EXPECT_LT(most, 1.9);
    // A site next to an edge has to have a short edge to it.
    if (site.x() != 0.0249) {
      EXPECT_GT(least, 0.35);
    }
  }
}

TEST(AdaptSurface, BallFollowsSizeAndVolume) {
  const Surface fine = test::sphere_surface({0, 0, 0}, 0.05, 5);
  const Body ball = test::body_of(fine, 0.006);
  const Vector3d site = fine.vertices[77];
  const SizeField size = test::size_round(site, 0.00175, 0.02);
  const AdaptedSurface a = adapt_surface(ball.base, *ball.query, size, {site});
  expect_sound(a, {site});
  EXPECT_GT(a.surface.triangles.size(), 200u);
  EXPECT_LT(a.surface.triangles.size(), 700u);
  const double volume_error = test::surface_volume(a.surface) / test::surface_volume(fine) - 1;
  RecordProperty("volume_error", std::to_string(volume_error));
  EXPECT_LT(std::abs(volume_error), 0.06);
  for (const Vector3d& v : a.surface.vertices) EXPECT_LT(ball.query->closest(v).distance, 1e-12);
  const auto [least, most] = relative_edges(a.surface, size);
  EXPECT_GT(least, 0.4);
  EXPECT_LT(most, 1.6);
}

TEST(AdaptSurface, FinerChordMeansSmallerVolumeError) {
  const Surface fine = test::sphere_surface({0, 0, 0}, 0.05, 4);
  const Body ball = test::body_of(fine, 0.006);
  const auto error = [&](double chord) {
    AdaptOptions options;
    options.chord = chord;
    const SizeField size = [](const Vector3d&) { return 0.04; };
    const Surface s = adapt_surface(ball.base, *ball.query, size, {}, options).surface;
    return std::abs(test::surface_volume(s) / test::surface_volume(fine) - 1);
  };
  EXPECT_LT(error(0.05), 0.6 * error(0.25));
}

TEST(AdaptSurface, SharpWedgeKeepsItsEdges) {
  // A thin wedge: 9 degrees between its long faces.
  Surface wedge;
  wedge.vertices = {{0, 0, 0},    {0.1, 0, -0.008},    {0.1, 0, 0.008},
                    {0, 0.06, 0}, {0.1, 0.06, -0.008}, {0.1, 0.06, 0.008}};
  wedge.triangles = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  for (auto& t : wedge.triangles) std::swap(t[1], t[2]);
  if (test::surface_volume(wedge) < 0) {
    for (auto& t : wedge.triangles) std::swap(t[1], t[2]);
  }
  test::set_one_part(wedge, "wedge");
  ASSERT_TRUE(test::closed_and_oriented(wedge));
  const Body body = test::body_of(wedge, 0.006);
  const Vector3d site(0.05, 0.03, 0.004);
  const AdaptedSurface a = adapt_surface(body.base, *body.query, test::size_round(site, 0.002, 0.02), {site});
  expect_sound(a, {site});
  EXPECT_NEAR(test::surface_volume(a.surface) / test::surface_volume(wedge), 1, 1e-9);
}

TEST(AdaptSurface, SameBytesEveryTime) {
  const Body ball = test::body_of(test::sphere_surface({0, 0, 0}, 0.05, 4), 0.006);
  const Vector3d site = ball.query->closest({0.03, 0.02, 0.05}).point;
  const SizeField size = test::size_round(site, 0.00175, 0.02);
  const AdaptedSurface a = adapt_surface(ball.base, *ball.query, size, {site});
  const AdaptedSurface b = adapt_surface(ball.base, *ball.query, size, {site});
  EXPECT_EQ(a.surface.vertices, b.surface.vertices);
  EXPECT_EQ(a.surface.triangles, b.surface.triangles);
}

TEST(AdaptSurface, SeveralAnchorsAllBecomeVertices) {
  const Body ball = test::body_of(test::sphere_surface({0, 0, 0}, 0.05, 4), 0.006);
  std::vector<Vector3d> anchors;
  for (const Vector3d& at : {Vector3d(1, 2, 3), Vector3d(1, 2.01, 3), Vector3d(-1, 0, 0.2), Vector3d(0, 0, -1)}) {
    anchors.push_back(ball.query->closest(at).point);
  }
  const SizeField size = [](const Vector3d&) { return 0.01; };
  expect_sound(adapt_surface(ball.base, *ball.query, size, anchors), anchors);
}

// A coarse base cuts the margin of a lens off, so that a site on the margin lies outside of it.
TEST(AdaptSurface, AnAnchorFarFromACoarseBaseMakesNoSpike) {
  const Surface lens = geometry::ellipsoid({0, 0, 0}, {0.03, 0.03, 0.004}, 0.0008, "lens");
  const geometry::SurfaceQuery query(lens);
  const Surface base = remesh_uniform(lens, 0.006);
  for (const double angle : {0.1, 0.2, 0.3, 0.4, 0.5}) {
    const Vector3d site = query.closest({0.03 * std::cos(angle), 0.03 * std::sin(angle), 0}).point;
    const AdaptedSurface a = adapt_surface(base, query, test::size_round(site, 0.0003, 0.01), {site});
    expect_sound(a, {site});
    // Next to the site every triangle is on the lens, and faces outwards.
    for (const auto& t : a.surface.triangles) {
      const Vector3d &u = a.surface.vertices[t[0]], &v = a.surface.vertices[t[1]], &w = a.surface.vertices[t[2]];
      const Vector3d middle = (u + v + w) / 3;
      if ((middle - site).norm() > 0.002) continue;
      EXPECT_LT(query.closest(middle).distance, 2e-4);
      EXPECT_GT((v - u).cross(w - u).dot(query.normal(middle, 0.0)), 0);
    }
  }
}

TEST(AdaptSurface, WrongInputsAreNamed) {
  const Body ball = test::body_of(test::sphere_surface({0, 0, 0}, 0.05, 3), 0.01);
  const auto cause = [&](const Surface& base, double h) {
    try {
      adapt_surface(base, *ball.query, [h](const Vector3d&) { return h; }, {});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(cause(ball.base, 0.0).find("allowed > 0"), std::string::npos);
  EXPECT_NE(cause(ball.base, std::numeric_limits<double>::quiet_NaN()).find("allowed > 0"), std::string::npos);
  EXPECT_NE(cause(ball.base, 1e-4).find("300 000"), std::string::npos);
  Surface open = ball.base;
  open.triangles.pop_back();
  EXPECT_NE(cause(open, 0.01).find("open"), std::string::npos);
  Surface doubled = ball.base;
  doubled.triangles.push_back(doubled.triangles[5]);
  EXPECT_NE(cause(doubled, 0.01).find("manifold"), std::string::npos);
}

}  // namespace
}  // namespace palpate::mesh
