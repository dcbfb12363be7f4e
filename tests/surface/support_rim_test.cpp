// SPDX-License-Identifier: GPL-3.0-or-later
// The rim of the held surface: where it lies, what size resolves it, and bodies that have none.
#include "precompute/surface/support_rim.hpp"

#include "tests/support/shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::surface {
namespace {

Body held_below(const Surface& surface, double z) {
  Body body;
  body.query = std::make_shared<const geometry::SurfaceQuery>(surface);
  Eigen::AlignedBox3d box;
  for (const auto& v : surface.vertices) box.extend(v);
  body.diagonal = box.diagonal().norm();
  SupportScene& support = body.supports.emplace_back();
  support.kind = SupportScene::Kind::half_space;
  support.point = {0, 0, z};
  support.normal = {0, 0, 1};
  body.support_surfaces.emplace_back();
  return body;
}

TEST(SupportRim, OfABallsCapIsACircle) {
  const double radius = 0.01, z = -0.008;
  const SupportRim rim = support_rim(held_below(test::sphere_surface({0, 0, 0}, radius, 5), z));
  const double ring = std::sqrt(radius * radius - z * z), pi = 3.14159265358979;
  const double cap = 2 * pi * radius * (radius + z), length = 2 * pi * ring;
  EXPECT_NEAR(rim.size, cap / (2 * length), 0.02 * rim.size);
  for (const auto& p : rim.points) {
    EXPECT_NEAR(p.z(), z, 1e-5);
    EXPECT_NEAR(p.head<2>().norm(), ring, 2e-5);
  }
  // One in each cell that the circle crosses.
  EXPECT_GT(double(rim.points.size()), 0.8 * length / rim.size);
  EXPECT_LT(double(rim.points.size()), 2.5 * length / rim.size);
}

// Twelve triangles: the rim runs through their middles and is found all the same.
TEST(SupportRim, OfABoxOfTwelveTrianglesRunsRoundIt) {
  const SupportRim rim = support_rim(held_below(test::box_surface({0, 0, 0}, {0.1, 0.1, 0.1}), 0.01));
  // Five faces' parts: the bottom and four strips 10 mm high, over 400 mm of rim.
  EXPECT_NEAR(rim.size, (0.01 + 4 * 0.001) / (2 * 0.4), 0.06 * rim.size);
  ASSERT_FALSE(rim.points.empty());
  bool sides[4] = {false, false, false, false};
  for (const auto& p : rim.points) {
    EXPECT_NEAR(p.z(), 0.01, 1e-4);
    sides[0] = sides[0] || p.x() < 1e-9;
    sides[1] = sides[1] || p.x() > 0.1 - 1e-9;
    sides[2] = sides[2] || p.y() < 1e-9;
    sides[3] = sides[3] || p.y() > 0.1 - 1e-9;
  }
  EXPECT_TRUE(sides[0] && sides[1] && sides[2] && sides[3]);
}

TEST(SupportRim, OfNothingOrEverythingIsEmpty) {
  const Surface ball = test::sphere_surface({0, 0, 0}, 0.01, 3);
  EXPECT_TRUE(support_rim(held_below(ball, -0.02)).points.empty());
  EXPECT_TRUE(support_rim(held_below(ball, 0.02)).points.empty());
}

}  // namespace
}  // namespace palpate::surface
