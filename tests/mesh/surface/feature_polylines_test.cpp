// SPDX-License-Identifier: GPL-3.0-or-later
// Feature lines of a box and of a disc.
#include "precompute/mesh/surface/feature_polylines.hpp"

#include "tests/support/shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;

double length(const std::vector<Vector3d>& line) {
  double sum = 0;
  for (std::size_t k = 1; k < line.size(); ++k) sum += (line[k] - line[k - 1]).norm();
  return sum;
}

TEST(FeaturePolylines, BoxHasTwelve) {
  const geometry::SurfaceQuery box(test::box_surface({0, 0, 0}, {1, 1, 1}, 3));
  const auto lines = feature_polylines(box, {});
  ASSERT_EQ(lines.size(), 12u);
  for (const auto& line : lines) {
    EXPECT_EQ(line.size(), 4u);
    EXPECT_NEAR(length(line), 1, 1e-12);
  }
}

TEST(FeaturePolylines, StopsCutALineAtTheirPoint) {
  const geometry::SurfaceQuery box(test::box_surface({0, 0, 0}, {1, 1, 1}, 2));
  EXPECT_EQ(feature_polylines(box, {{0.3, 0, 0}}).size(), 13u);
  EXPECT_EQ(feature_polylines(box, {{0.5, 0, 0}, {0.5, 0, 1}}).size(), 14u) << "at vertices of the surface";
  EXPECT_EQ(feature_polylines(box, {{0.5, 0.5, 0}, {0, 0, 0}}).size(), 12u) << "inside a face, at a corner";
}

TEST(FeaturePolylines, RimsOfADiscCloseOnThemselves) {
  Surface disc;
  constexpr int n = 40;
  for (const double z : {0.0, 1.0}) {
    for (int k = 0; k < n; ++k) {
      const double turn = 2 * std::numbers::pi * k / n;
      disc.vertices.emplace_back(std::cos(turn), std::sin(turn), z);
    }
  }
  disc.vertices.emplace_back(0, 0, 0);
  disc.vertices.emplace_back(0, 0, 1);
  for (int k = 0; k < n; ++k) {
    const int l = (k + 1) % n;
    disc.triangles.push_back({2 * n, l, k});
    disc.triangles.push_back({2 * n + 1, n + k, n + l});
    disc.triangles.push_back({k, l, n + l});
    disc.triangles.push_back({k, n + l, n + k});
  }
  test::set_one_part(disc, "disc");
  ASSERT_TRUE(test::closed_and_oriented(disc));
  const auto lines = feature_polylines(geometry::SurfaceQuery(disc), {});
  ASSERT_EQ(lines.size(), 2u);
  for (const auto& line : lines) {
    EXPECT_EQ(line.front(), line.back());
    EXPECT_EQ(line.size(), n + 1u);
  }
}

}  // namespace
}  // namespace palpate::mesh
