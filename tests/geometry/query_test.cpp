// SPDX-License-Identifier: GPL-3.0-or-later
// Surface queries against the ball, the box and thin plates, whose answers are known.
#include "precompute/geometry/query.hpp"

#include "formats/io/error.hpp"
#include "tests/support/shapes.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <random>
#include <thread>

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> points_in_cube(double half, int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-half, half);
  std::vector<Vector3d> points(static_cast<std::size_t>(count));
  for (Vector3d& p : points) p = {coordinate(random), coordinate(random), coordinate(random)};
  return points;
}

double box_distance(const Vector3d& p, const Vector3d& half) {
  const Vector3d q = p.cwiseAbs() - half;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

TEST(SurfaceQuery, BoxDistanceIsExactEverywhere) {
  const Vector3d half(0.05, 0.03, 0.02);
  for (const int n : {1, 3}) {
    const SurfaceQuery box(test::box_surface(-half, half, n));
    for (const Vector3d& p : points_in_cube(0.08, 3000)) {
      EXPECT_NEAR(box.signed_distance(p), box_distance(p, half), 1e-14) << p.transpose();
      const ClosestPoint c = box.closest(p);
      EXPECT_NEAR(c.distance, std::abs(box_distance(p, half)), 1e-14);
      EXPECT_NEAR((c.point - p).norm(), c.distance, 1e-15);
      EXPECT_NEAR(box_distance(c.point, half), 0, 1e-15);
      ASSERT_GE(c.triangle, 0);
    }
  }
}

TEST(SurfaceQuery, SignIsRightOffVerticesAndEdges) {
  // Straight off a corner or an edge the nearest triangles disagree about the side; the pseudo-normal does not.
  const Surface surface = test::sphere_surface({0, 0, 0}, 1.0, 2);
  const SurfaceQuery ball(surface);
  for (const auto& t : surface.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vector3d vertex = surface.vertices[t[k]];
      const Vector3d middle = (vertex + surface.vertices[t[(k + 1) % 3]]) / 2;
      for (const Vector3d& p : {vertex, middle}) {
        EXPECT_GT(ball.signed_distance(1.3 * p), 0);
        EXPECT_LT(ball.signed_distance(0.9 * p), 0);
      }
    }
  }
}

TEST(SurfaceQuery, SoupOfSeparateTrianglesHasTheSameSign) {
  const Surface box = test::box_surface({-1, -1, -1}, {1, 1, 1}, 2);
  Surface soup;
  for (const auto& t : box.triangles) {
    const auto first = static_cast<std::int32_t>(soup.vertices.size());
    for (const std::int32_t v : t) soup.vertices.push_back(box.vertices[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  test::set_one_part(soup, "soup");
  const SurfaceQuery whole(box), loose(soup);
  for (const Vector3d& p : points_in_cube(1.5, 500)) {
    EXPECT_NEAR(whole.signed_distance(p), loose.signed_distance(p), 1e-13);
  }
}

TEST(SurfaceQuery, BallDistanceWithinItsChordalError) {
  const double radius = 0.05;
  const SurfaceQuery ball(test::sphere_surface({0, 0, 0}, radius, 4));
  for (const Vector3d& p : points_in_cube(0.08, 2000)) {
    EXPECT_NEAR(ball.signed_distance(p), p.norm() - radius, 0.002 * radius);
  }
}

TEST(SurfaceQuery, RayHitsWallsInOrderAndMissesOutside) {
  const SurfaceQuery box(test::box_surface({-1, -1, -1}, {1, 1, 1}));
  // Through the faces' diagonals and an edge: ties between triangles must not lose the hit.
  EXPECT_NEAR(box.ray({0, 0, 5}, {0, 0, -1}, 0).value(), 4, 1e-14);
  EXPECT_NEAR(box.ray({0, 0, 5}, {0, 0, -1}, 4.5).value(), 6, 1e-14);
  EXPECT_NEAR(box.ray({0, 0, 0}, {0, 0, -1}, 0).value(), 1, 1e-14);
  EXPECT_NEAR(box.ray({3, 0, 1}, {-1, 0, 0}, 0).value(), 2, 1e-14);
  EXPECT_FALSE(box.ray({0, 0, 5}, {0, 0, 1}, 0).has_value());
  EXPECT_FALSE(box.ray({0, 0, 5}, {0, 0, -1}, 6.5).has_value());
}

TEST(SurfaceQuery, ThicknessOfBoxBallAndRim) {
  const SurfaceQuery box(test::box_surface({-0.05, -0.05, 0}, {0.05, 0.05, 0.02}, 4));
  EXPECT_NEAR(box.thickness({0.01, 0.02, 0.02}, {0, 0, 1}), 0.02, 1e-12);
  // Close to the rim the side wall is not the opposite wall.
  EXPECT_NEAR(box.thickness({0.0499, 0.02, 0.02}, {0, 0, 1}), 0.02, 1e-12);
  EXPECT_NEAR(box.thickness({0.05, 0.001, 0.01}, {1, 0, 0}), 0.1, 1e-12);
  const SurfaceQuery ball(test::sphere_surface({0, 0, 0}, 0.05, 4));
  const Vector3d out = Vector3d(1, 2, 3).normalized();
  const double cone = 15 * std::numbers::pi / 180;
  EXPECT_NEAR(ball.thickness(ball.closest(0.06 * out).point, out), 0.1 * std::cos(cone), 4e-4);
}

TEST(SurfaceQuery, ThicknessWithNothingOppositeIsTheDiagonal) {
  Surface plate;
  plate.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  plate.triangles = {{0, 1, 2}};
  test::set_one_part(plate, "plate");
  EXPECT_NEAR(SurfaceQuery(plate).thickness({0.2, 0.2, 0}, {0, 0, 1}), std::sqrt(2.0), 1e-12);
}

TEST(SurfaceQuery, NormalAveragesOverItsRadius) {
  const SurfaceQuery box(test::box_surface({-1, -1, -1}, {1, 1, 1}));
  EXPECT_NEAR((box.normal({0.2, 0.1, 1}, 0.0) - Vector3d(0, 0, 1)).norm(), 0, 1e-15);
  EXPECT_NEAR((box.normal({0.2, 0.1, 1}, 0.5) - Vector3d(0, 0, 1)).norm(), 0, 1e-15);
  EXPECT_NEAR((box.normal({1, 0.1, 1}, 0.3) - Vector3d(1, 0, 1).normalized()).norm(), 0, 1e-2);
  const SurfaceQuery ball(test::sphere_surface({0, 0, 0}, 0.05, 4));
  for (const Vector3d& p : points_in_cube(0.05, 200)) {
    EXPECT_NEAR((ball.normal(0.05 * p.normalized(), 0.01) - p.normalized()).norm(), 0, 0.01);
  }
}

TEST(SurfaceQuery, NormalIgnoresTheFarWallOfAThinPlate) {
  const SurfaceQuery plate(test::box_surface({-1, -1, 0}, {1, 1, 0.01}, 4));
  EXPECT_NEAR((plate.normal({0.1, 0.2, 0.01}, 0.3) - Vector3d(0, 0, 1)).norm(), 0, 1e-12);
  EXPECT_NEAR((plate.normal({0.1, 0.2, 0}, 0.3) - Vector3d(0, 0, -1)).norm(), 0, 1e-12);
}

TEST(SurfaceQuery, FeaturesAreTheSharpEdgesOnly) {
  const SurfaceQuery box(test::box_surface({-1, -1, -1}, {1, 1, 1}, 3));
  EXPECT_NEAR((box.closest_on_feature({0.9, 0.2, 0.8}).value() - Vector3d(1, 0.2, 1)).norm(), 0, 1e-14);
  EXPECT_NEAR((box.closest_on_feature({3, 3, 3}).value() - Vector3d(1, 1, 1)).norm(), 0, 1e-14);
  EXPECT_FALSE(SurfaceQuery(test::sphere_surface({0, 0, 0}, 1, 2)).closest_on_feature({1, 0, 0}).has_value());
}

TEST(SurfaceQuery, ConcurrentQueriesEqualSerialOnes) {
  const SurfaceQuery ball(test::sphere_surface({0, 0, 0}, 0.05, 3));
  const std::vector<Vector3d> points = points_in_cube(0.08, 2000);
  const auto answers = [&] {
    std::vector<double> all;
    for (const Vector3d& p : points) {
      all.push_back(ball.signed_distance(p));
      all.push_back(ball.thickness(ball.closest(p).point, ball.normal(p, 0.01)));
    }
    return all;
  };
  std::vector<double> first, second;
  std::thread one([&] { first = answers(); }), two([&] { second = answers(); });
  one.join();
  two.join();
  const std::vector<double> serial = answers();
  EXPECT_EQ(first, serial);
  EXPECT_EQ(second, serial);
}

TEST(SurfaceQuery, BadSurfacesAreRefusedWithTheirElement) {
  const auto message = [](const Surface& s) {
    try {
      const SurfaceQuery query(s);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message({}).find("without triangles"), std::string::npos);
  Surface box = test::box_surface({-1, -1, -1}, {1, 1, 1});
  box.triangles[2][1] = 99;
  EXPECT_NE(message(box).find("triangle 2: vertex 99"), std::string::npos);
  box = test::box_surface({-1, -1, -1}, {1, 1, 1});
  box.vertices[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(box).find("vertex 3"), std::string::npos);
  box = test::box_surface({1, 1, 1}, {1, 1, 1});
  EXPECT_NE(message(box).find("area"), std::string::npos);
}

TEST(SurfaceQuery, TrianglesWithoutAreaDoNotDisturb) {
  Surface box = test::box_surface({-1, -1, -1}, {1, 1, 1});
  box.triangles.push_back({0, 1, 1});
  box.parts.push_back(0);
  const SurfaceQuery query(box);
  for (const Vector3d& p : points_in_cube(1.5, 500)) {
    EXPECT_NEAR(query.signed_distance(p), box_distance(p, {1, 1, 1}), 1e-13);
  }
}

TEST(SurfaceQuery, PointThatIsNotFiniteIsAnError) {
  const SurfaceQuery box(test::box_surface({-1, -1, -1}, {1, 1, 1}));
  EXPECT_THROW((void)box.closest({std::numeric_limits<double>::quiet_NaN(), 0, 0}), Error);
  EXPECT_THROW((void)box.ray({0, 0, 0}, {0, 0, 0}, 0), Error);
}

}  // namespace
}  // namespace palpate::geometry
