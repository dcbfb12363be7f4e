// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest points, signs and the projection along smooth normals, on a box and a ball with known answers.
#include <algorithm>
#include <cmath>

#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::locate;
using runtime::Location;
using runtime::project;
using runtime::Projection;

double box_distance(const Vec3& p) {
  const double h = kBoxSize / 2, q[3] = {std::fabs(p.x) - h, std::fabs(p.y) - h, std::fabs(p.z) - h / 2};
  const double outside =
      std::sqrt(std::pow(std::max(q[0], 0.0), 2) + std::pow(std::max(q[1], 0.0), 2) + std::pow(std::max(q[2], 0.0), 2));
  return outside + std::min(0.0, std::max({q[0], q[1], q[2]}));
}

Vec3 random_point(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> unit(-size, size);
  return {unit(random), unit(random), unit(random)};
}

TEST(Locate, SignedDistanceToABoxWithAndWithoutSearch) {
  for (const bool search : {false, true}) {
    Options options;
    options.search = search;
    const Opened box(box_content(options));
    std::mt19937 random(1);
    for (int i = 0; i < 4000; ++i) {
      Vec3 p = random_point(random, 0.05);
      if (i % 4 == 0) p = {std::round(p.x / 0.015) * 0.015, std::round(p.y / 0.015) * 0.015, p.z};  // over vertices
      const Location found = locate(box.view, p);
      ASSERT_NEAR(found.signed_distance, box_distance(p), 2e-8) << p.x << " " << p.y << " " << p.z;
      ASSERT_NEAR(distance(p, found.point), std::fabs(found.signed_distance), 1e-12);
      double sum = 0;
      for (const double b : found.at.bary) {
        ASSERT_GE(b, 0);
        sum += b;
      }
      ASSERT_NEAR(sum, 1, 1e-12);
    }
  }
}

TEST(Locate, FindsTheSameWhereverTheSearchBegins) {
  for (const bool search : {false, true}) {
    Options options;
    options.search = search;
    options.subdivision = 4;
    const Opened ball(ball_content(options));
    std::mt19937 random(4);
    Location last;
    for (int i = 0; i < 3000; ++i) {
      Vec3 p = random_point(random, 0.05);
      if (i % 3 == 0) p = last.point + 1e-3 * p;  // near the last
      if (i % 9 == 0) p = last.point;             // on the surface, but for rounding
      if (i % 9 == 3) p = runtime::vertex(ball.view, i % ball.view.meta->vertex_count);  // where triangles tie
      const Location found = locate(ball.view, p);
      const runtime::BodyPoint anywhere{static_cast<std::uint32_t>(random() % ball.view.meta->triangle_count),
                                        {0.2, 0.3, 0.5}};
      for (const runtime::BodyPoint& near : {anywhere, last.at, found.at}) {
        const Location same = locate(ball.view, p, near);
        ASSERT_EQ(same.at.triangle, found.at.triangle) << i;
        for (int k = 0; k < 3; ++k) ASSERT_EQ(same.at.bary[k], found.at.bary[k]) << i;
        ASSERT_EQ(same.signed_distance, found.signed_distance) << i;
      }
      last = found;
    }
  }
}

TEST(Locate, SurvivesTrianglesWithoutArea) {
  ResponseFileContent content = box_content();
  // Pulls a vertex of the top's inside onto its neighbour: triangles between them shrink to lines.
  const auto& t = content.surface_triangles[40];
  content.surface_vertices[t.vertices[0]] = content.surface_vertices[t.vertices[1]];
  const Opened box(std::move(content));
  std::mt19937 random(2);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random_point(random, 0.05);
    const Location found = locate(box.view, p);
    ASSERT_TRUE(std::isfinite(found.signed_distance));
    ASSERT_TRUE(std::isfinite(project(box.view, found.at, p).height));
  }
}

TEST(Project, OnABallTheNormalsMeetTheCentreRay) {
  Options options;
  options.subdivision = 4;
  const Opened ball(ball_content(options));
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 direction = random_direction(random);
    const double radius = kBallRadius * (0.7 + 0.6 * (i % 11) / 10.0);
    const Vec3 q = radius * direction;
    const Projection found = project(ball.view, locate(ball.view, q).at, q);
    ASSERT_TRUE(found.converged) << i;
    EXPECT_LT(found.residual, 1e-10);
    EXPECT_NEAR(distance(q, found.point + found.height * found.normal), 0, 1e-10);
    // Interpolated normals are not exactly radial, and the facets lie a little inside the ball.
    EXPECT_NEAR(found.height, radius - kBallRadius, 3e-4);
    EXPECT_GT(dot(found.normal, direction), 0.99);
  }
}

TEST(Project, WalksFarOverTheSurface) {
  Options options;
  options.subdivision = 4;
  const Opened ball(ball_content(options));
  std::mt19937 random(4);
  for (int i = 0; i < 500; ++i) {
    const Vec3 a = random_direction(random), b = random_direction(random);
    if (dot(a, b) < 0.5) continue;  // 60 degrees: some 20 triangles
    const Vec3 q = 1.1 * kBallRadius * b;
    const Projection found = project(ball.view, locate(ball.view, kBallRadius * a).at, q);
    ASSERT_TRUE(found.converged);
    EXPECT_LT(distance(found.point, kBallRadius * b), 1e-3);
  }
}

TEST(Project, MovesContinuouslyWithThePoint) {
  Options options;
  options.subdivision = 3;
  const Opened ball(ball_content(options));
  std::mt19937 random(5);
  for (int path = 0; path < 20; ++path) {
    const Vec3 a = random_direction(random), b = unit(cross(a, random_direction(random)), {1, 0, 0});
    runtime::BodyPoint at = locate(ball.view, kBallRadius * a).at;
    Vec3 last;
    for (int i = 0; i <= 2000; ++i) {
      const double angle = 1.5 * i / 2000.0;
      const Projection found = project(ball.view, at, 1.1 * kBallRadius * (std::cos(angle) * a + std::sin(angle) * b));
      ASSERT_TRUE(found.converged);
      if (i > 0) {
        ASSERT_LT(distance(found.point, last), 2 * kBallRadius * 1.5 / 2000.0);
      }
      last = found.point;
      at = found.at;
    }
  }
}

TEST(BodyPoint, CrossingAnEdgeKeepsPlaceWeightsAndNormal) {
  Options options;
  options.subdivision = 3;
  const Opened ball(ball_content(options));
  for (std::uint32_t t = 0; t < ball.view.meta->triangle_count; ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      runtime::BodyPoint here{t, {0, 0, 0}};
      here.bary[(corner + 1) % 3] = 0.3;
      here.bary[(corner + 2) % 3] = 0.7;
      const runtime::BodyPoint there = runtime::cross_edge(ball.view, here, corner);
      ASSERT_LT(distance(position(ball.view, here), position(ball.view, there)), 1e-15);
      ASSERT_LT(distance(normal(ball.view, here), normal(ball.view, there)), 1e-12);
    }
  }
}

}  // namespace
}  // namespace palpate
