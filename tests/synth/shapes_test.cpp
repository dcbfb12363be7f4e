// SPDX-License-Identifier: GPL-3.0-or-later
// Every generated surface is closed, outward and of the volume that its shape has.
#include "datasets-synthetic/shapes.hpp"
#include "datasets-synthetic/liver.hpp"
#include "tests/synth/surface_checks.hpp"

#include <gtest/gtest.h>
#include <numbers>

namespace palpate::synth {
namespace {

using std::numbers::pi;

void expect_solid(const Surface& s, double expected_volume, double relative) {
  EXPECT_EQ(test::edge_faults(s), 0);
  EXPECT_EQ(test::euler(s), 2);
  EXPECT_EQ(s.parts.size(), s.triangles.size());
  EXPECT_NEAR(test::volume(s), expected_volume, relative * expected_volume);
}

TEST(Shapes, GeodesicSphereHasItsCounts) {
  for (const int frequency : {1, 2, 3, 7}) {
    const Surface s = geometry::geodesic_sphere(frequency, "sphere");
    EXPECT_EQ(s.triangles.size(), static_cast<std::size_t>(20 * frequency * frequency));
    EXPECT_EQ(s.vertices.size(), static_cast<std::size_t>(10 * frequency * frequency + 2));
    EXPECT_EQ(test::edge_faults(s), 0);
  }
  expect_solid(geometry::geodesic_sphere(20, "sphere"), 4 * pi / 3, 0.01);
}

TEST(Shapes, EllipsoidHasVolumeAndEdges) {
  const Surface s = geometry::ellipsoid({1, 2, 3}, {0.03, 0.02, 0.01}, 0.001, "e");
  expect_solid(s, 4 * pi / 3 * 6e-6, 0.01);
  EXPECT_NEAR(test::mean_edge(s), 0.001, 0.0003);
}

TEST(Shapes, BoxIsExact) {
  const Surface s = box({0.12, 0.08, 0.05}, 0.01, "box");
  expect_solid(s, 0.12 * 0.08 * 0.05, 1e-12);
  for (const Eigen::Vector3d& v : s.vertices) EXPECT_LE(v.z(), 0.0);
  expect_solid(box({1, 1, 1}, 5, "one cell"), 1.0, 1e-12);
}

TEST(Shapes, Tools) {
  const double r = 0.004, l = 0.03;
  expect_solid(sphere_tool(r), 4 * pi / 3 * r * r * r, 0.02);
  const Surface capsule = capsule_tool(r, l);
  expect_solid(capsule, 4 * pi / 3 * r * r * r + pi * r * r * l, 0.02);
  double lowest = 1;
  for (const Eigen::Vector3d& v : capsule.vertices) lowest = std::min(lowest, v.z());
  EXPECT_DOUBLE_EQ(lowest, -r);  // the tip cap's centre is the origin
  const Surface stylus = stylus_tool(0.001, 0.003, 0.04);
  EXPECT_EQ(test::edge_faults(stylus), 0);
  EXPECT_EQ(test::euler(stylus), 2);
  EXPECT_GT(test::volume(stylus), 0.0);
}

class Liver : public testing::TestWithParam<std::uint64_t> {};

TEST_P(Liver, IsAStarShapedSolidOfAPlausibleSize) {
  const LiverShape shape(GetParam(), 1.0);
  const Surface s = liver_surface(shape, 0.005);
  EXPECT_EQ(test::edge_faults(s), 0);
  EXPECT_EQ(test::euler(s), 2);
  // Every triangle faces away from the origin and together they see it once: no self-intersection.
  double solid_angle = 0;
  for (const auto& t : s.triangles) {
    const auto [a, b, c] = test::corners(s, t);
    const double det = a.dot(b.cross(c));
    ASSERT_GT(det, 0.0);
    solid_angle += 2 * std::atan2(det, a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() + b.dot(c) * a.norm() +
                                           c.dot(a) * b.norm());
  }
  EXPECT_NEAR(solid_angle, 4 * pi, 1e-9);
  EXPECT_GT(test::smallest_angle(s), 10.0);
  EXPECT_NEAR(test::mean_edge(s), 0.005, 0.001);
  Eigen::AlignedBox3d bounds;
  for (const Eigen::Vector3d& v : s.vertices) bounds.extend(v);
  EXPECT_GT(bounds.sizes().x(), 0.13);
  EXPECT_LT(bounds.sizes().x(), 0.18);
  // The left lobe's margin is thin: seen along x at its end it is less than 20 mm high.
  Eigen::AlignedBox3d margin;
  for (const Eigen::Vector3d& v : s.vertices) {
    if (v.x() > bounds.max().x() - 0.006) margin.extend(v);
  }
  EXPECT_LT(margin.sizes().z(), 0.02);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Liver, testing::Values(0, 1, 2, 3, 17, 1234567, ~0ULL));

TEST(LiverSeed, ChangesTheShape) {
  const LiverShape one(1, 1.0), two(2, 1.0);
  EXPECT_GT(std::abs(one.radius({0, 0, 1}) - two.radius({0, 0, 1})), 1e-5);
}

}  // namespace
}  // namespace palpate::synth
