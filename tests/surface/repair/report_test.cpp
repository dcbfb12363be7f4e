// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of shapes with known answers, and the flag for thin bags.
#include "precompute/surface/repair/report.hpp"

#include "precompute/geometry/topology.hpp"
#include "tests/surface/faulty_shapes.hpp"

namespace palpate::test {
namespace {

SurfaceReport measured(const Surface& s) {
  SurfaceReport report;
  surface::measure(geometry::SurfaceQuery(s), report);
  return report;
}

// The facet depth of a ball is the mean gap between the ball and its facets' middles; sharp edges of a box have none.
TEST(Report, FacetsOfABallAndOfABox) {
  const Surface ball = sphere_surface({0, 0, 0}, 0.01, 2);
  double lacking = 0;
  for (const auto& t : ball.triangles) {
    lacking += 0.01 - (ball.vertices[t[0]] + ball.vertices[t[1]] + ball.vertices[t[2]]).norm() / 3;
  }
  lacking /= double(ball.triangles.size());
  SurfaceReport report;
  surface::measure(geometry::SurfaceQuery(ball), report);
  EXPECT_NEAR(report.facet_depth / lacking, 1, 0.1);
  surface::measure(geometry::SurfaceQuery(box_surface({0, 0, 0}, {0.1, 0.1, 0.1}, 3)), report);
  EXPECT_LT(report.facet_depth, 1e-12);
}

TEST(Report, SlabThickness) {
  const auto report = measured(box_surface({0, 0, 0}, {0.2, 0.3, 0.02}, 8));
  EXPECT_NEAR(report.volume, 0.2 * 0.3 * 0.02, 1e-15);
  EXPECT_NEAR(report.area, 2 * (0.06 + 0.004 + 0.006), 1e-12);
  EXPECT_NEAR(report.thickness_median, 0.02, 1e-6);
  EXPECT_LE(report.thickness_min, 0.0200001);
  EXPECT_LE(report.thickness_min, report.thickness_p05);
  EXPECT_LE(report.thickness_p05, report.thickness_median);
  EXPECT_FALSE(report.thin_bag);
}

TEST(Report, BallThickness) {
  // Along the normal it is the diameter, at the rim of the cone (15 degrees from the normal of a facet, which leans up
  // to 2.5 itself) the diameter times the cosine of the tilt.
  const auto report = measured(sphere_surface({1, 2, 3}, 0.1, 4));
  EXPECT_NEAR(report.volume, 4.0 / 3 * std::numbers::pi * 1e-3, 2e-5);
  EXPECT_GE(report.thickness_min, 0.2 * std::cos(17.5 / 180 * std::numbers::pi) - 0.0005);
  EXPECT_LE(report.thickness_median, 0.2);
}

TEST(Report, ThinBags) {
  EXPECT_TRUE(measured(bowl(0.003)).thin_bag);
  EXPECT_FALSE(measured(bowl(0.05)).thin_bag) << "a thick bowl is a solid";
  EXPECT_FALSE(measured(bent_rod()).thin_bag) << "a vessel is thin, but no sheet";
  EXPECT_FALSE(measured(box_surface({0, 0, 0}, {0.2, 0.2, 0.003}, 8)).thin_bag) << "a plate is round nothing";
  EXPECT_FALSE(measured(sphere_surface({0, 0, 0}, 0.1)).thin_bag);
  Surface inner = sphere_surface({0, 0, 0}, 0.098);
  for (auto& t : inner.triangles) std::swap(t[1], t[2]);
  EXPECT_FALSE(measured(together(sphere_surface({0, 0, 0}, 0.1), inner)).thin_bag) << "a shell with a cavity";
}

TEST(Report, PointsAreSpreadByAreaAndAlwaysTheSame) {
  const Surface s = box_surface({0, 0, 0}, {1, 1, 3}, 3);
  const auto points = surface::spread_points(s, 1400);
  ASSERT_EQ(points.size(), 1400U);
  int top = 0, side = 0;
  Eigen::Vector3d mean(0, 0, 0);
  for (const auto& p : points) {
    top += p.normal.z() > 0.9;
    side += p.normal.x() > 0.9;
    mean += p.point / 1400;
    const auto& t = s.triangles[std::size_t(p.triangle)];
    EXPECT_LE(std::abs(p.normal.dot(p.point - s.vertices[std::size_t(t[0])])), 1e-12);
  }
  EXPECT_NEAR(top, 100, 2);
  EXPECT_NEAR(side, 300, 2);
  EXPECT_LE((mean - Eigen::Vector3d(0.5, 0.5, 1.5)).norm(), 0.03);
  EXPECT_EQ(surface::spread_points(s, 1400)[777].point, points[777].point);
}

TEST(Report, TextSaysWhatMatters) {
  SurfaceReport report = measured(bowl(0.003));
  report.action = "wrapped";
  report.findings = {"open: 7 boundary edges in 1 loops"};
  report.largest_move = 0.0012;
  const auto lines = surface::text(report);
  for (const std::string piece : {"wrapped", "7 boundary edges", "1.2 mm", "mL", "median", "WARNING"}) {
    EXPECT_NE(lines.find(piece), std::string::npos) << piece << " in:\n" << lines;
  }
  EXPECT_EQ(surface::text(measured(cube())).find("WARNING"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test
