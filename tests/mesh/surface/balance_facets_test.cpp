// SPDX-License-Identifier: GPL-3.0-or-later
// Facets of round bodies enclose their volume; flat bodies and creases stay where they are.
#include "precompute/mesh/surface/balance_facets.hpp"

#include "precompute/geometry/intersections.hpp"
#include "precompute/geometry/solids.hpp"
#include "precompute/mesh/surface/adapt_surface.hpp"
#include "tests/mesh/bodies.hpp"

#include <gtest/gtest.h>

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;

constexpr double kRadius = 0.02;

// `hollow` is turned to face inward.
Surface with_hollow(Surface outside, const Surface& hollow) {
  const auto first = static_cast<std::int32_t>(outside.vertices.size());
  outside.vertices.insert(outside.vertices.end(), hollow.vertices.begin(), hollow.vertices.end());
  for (const auto& t : hollow.triangles) outside.triangles.push_back({t[0] + first, t[2] + first, t[1] + first});
  test::set_one_part(outside, "ball");
  return outside;
}

TEST(BalanceFacets, CoarseFacetsEncloseTheVolumeOfABall) {
  const Body ball = test::body_of(test::sphere_surface({0, 0, 0}, kRadius, 5), 0.3 * kRadius);
  const Vector3d site = ball.query->closest({0, 0, kRadius}).point;
  const double volume = test::surface_volume(ball.query->surface());
  const AdaptedSurface coarse =
      adapt_surface(ball.base, *ball.query, test::size_round(site, 0.1 * kRadius, 0.6 * kRadius), {site});
  const Surface balanced = balance_facets(coarse.surface, *ball.query, coarse.anchors);
  EXPECT_LT(test::surface_volume(coarse.surface) / volume, 0.97);
  EXPECT_NEAR(test::surface_volume(balanced) / volume, 1, 0.004);
  EXPECT_FALSE(geometry::self_intersects(balanced));
  EXPECT_EQ(balanced.vertices[coarse.anchors[0]], site);
  EXPECT_EQ(balanced.triangles, coarse.surface.triangles);
}

TEST(BalanceFacets, AWallOfACavityMovesIntoTheMaterial) {
  const Surface shell =
      with_hollow(test::sphere_surface({0, 0, 0}, kRadius, 4), test::sphere_surface({0, 0, 0}, 0.6 * kRadius, 4));
  const geometry::SurfaceQuery query(shell);
  const Surface coarse =
      with_hollow(test::sphere_surface({0, 0, 0}, kRadius, 2), test::sphere_surface({0, 0, 0}, 0.6 * kRadius, 2));
  const Surface balanced = balance_facets(coarse, query, {});
  EXPECT_NEAR(test::surface_volume(balanced) / test::surface_volume(shell), 1, 0.004);
  for (std::size_t v = 0; v < coarse.vertices.size(); ++v) {
    EXPECT_GT(balanced.vertices[v].norm(), coarse.vertices[v].norm());
  }
}

TEST(BalanceFacets, ABlockStaysABlock) {
  const Body block = test::block_body(0.005);
  const AdaptedSurface adapted =
      adapt_surface(block.base, *block.query, test::size_round({0, 0, 0}, 0.00175, 0.008), {{0, 0, 0}});
  const Surface balanced = balance_facets(adapted.surface, *block.query, adapted.anchors);
  for (std::size_t v = 0; v < balanced.vertices.size(); ++v) {
    EXPECT_LT((balanced.vertices[v] - adapted.surface.vertices[v]).norm(), 1e-12);
  }
}

TEST(BalanceFacets, ACylinderKeepsFlatEndsAndHasItsVolume) {
  std::vector<geometry::ProfilePoint> profile;
  for (int k = 0; k < 20; ++k) profile.push_back({kRadius * k / 20, -kRadius});
  for (int k = 0; k <= 40; ++k) profile.push_back({kRadius, kRadius * (k / 20.0 - 1)});
  for (int k = 19; k >= 0; --k) profile.push_back({kRadius * k / 20, kRadius});
  const Surface cylinder = geometry::revolved(profile, 200, "cylinder");
  const Body body = test::body_of(cylinder, 0.15 * kRadius);
  const Vector3d site(0, 0, kRadius);
  const AdaptedSurface adapted =
      adapt_surface(body.base, *body.query, test::size_round(site, 0.1 * kRadius, 0.6 * kRadius), {site});
  const Surface balanced = balance_facets(adapted.surface, *body.query, adapted.anchors);
  EXPECT_LT(test::surface_volume(adapted.surface) / test::surface_volume(cylinder), 0.98);
  EXPECT_NEAR(test::surface_volume(balanced) / test::surface_volume(cylinder), 1, 0.002);
  for (std::size_t v = 0; v < balanced.vertices.size(); ++v) {
    if (std::abs(std::abs(adapted.surface.vertices[v].z()) - kRadius) > 1e-9) continue;
    EXPECT_NEAR(balanced.vertices[v].z(), adapted.surface.vertices[v].z(), 0.005 * kRadius);
  }
}

TEST(BalanceFacets, VerticesStayWhereFacetsWouldCross) {
  // Two balls whose corners nearly touch.
  const double gap = 0.0002 * kRadius;
  const Surface coarse = test::sphere_surface({0, 0, 0}, kRadius, 1),
                fine = test::sphere_surface({0, 0, 0}, kRadius, 4);
  const Vector3d away = (2 * kRadius + gap) * coarse.vertices.front().normalized();
  const auto twin = [&](const Surface& ball) {
    Surface both = ball;
    const auto first = static_cast<std::int32_t>(both.vertices.size());
    for (const Vector3d& v : ball.vertices) both.vertices.push_back(away - v);
    for (const auto& t : ball.triangles) both.triangles.push_back({t[0] + first, t[2] + first, t[1] + first});
    test::set_one_part(both, "balls");
    return both;
  };
  const geometry::SurfaceQuery query(twin(fine));
  const Surface start = twin(coarse), balanced = balance_facets(start, query, {});
  EXPECT_FALSE(geometry::self_intersects(start));
  EXPECT_FALSE(geometry::self_intersects(balanced));
  EXPECT_GT(test::surface_volume(balanced), 1.05 * test::surface_volume(start));
}

}  // namespace
}  // namespace palpate::mesh
