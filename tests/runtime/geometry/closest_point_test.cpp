// SPDX-License-Identifier: GPL-3.0-or-later
// Closest points and signed distances against brute force, closed forms and the winding number; walks; the tracker.
#include "palpate/geometry/closest_point.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/runtime/support.hpp"
#include "tests/support/concave_samples.hpp"

namespace palpate::closest_point_test {
namespace {

using namespace test;
using runtime::BodyPoint;
using runtime::closest_point;
using runtime::ClosestPointTracker;
using runtime::local_closest_point;
using runtime::Location;
using runtime::View;
using runtime::detail::closest_on_triangle;

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

// Distance to a triangle by regions of its corners, edges and face: written apart from the runtime's.
double plain_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto to_segment = [&](const Vec3& u, const Vec3& v) {
    const Vec3 way = v - u;
    const double size = dot(way, way), s = size > 0 ? std::clamp(dot(p - u, way) / size, 0.0, 1.0) : 0;
    return distance(p, u + s * way);
  };
  double least = std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
  const Vec3 n = cross(b - a, c - a);
  if (!(length(n) > 0)) return least;
  const Vec3 unit_n = (1 / length(n)) * n, foot = p - dot(p - a, unit_n) * unit_n;
  const auto left_of = [&](const Vec3& u, const Vec3& v) { return dot(cross(v - u, foot - u), unit_n) >= 0; };
  if (left_of(a, b) && left_of(b, c) && left_of(c, a)) least = std::min(least, std::fabs(dot(p - a, unit_n)));
  return least;
}

double brute_force(const View& view, const Vec3& p) {
  double least = HUGE_VAL;
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
    const auto& v = view.triangle(t).vertex;
    least = std::min(least, plain_distance(p, vertex(view, v[0]), vertex(view, v[1]), vertex(view, v[2])));
  }
  return least;
}

// Solid angle of the surface over 4 pi (van Oosterom and Strackee 1983): 1 inside, 0 outside.
double winding_number(const View& view, const Vec3& p) {
  double sum = 0;
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
    const auto& v = view.triangle(t).vertex;
    const Vec3 a = vertex(view, v[0]) - p, b = vertex(view, v[1]) - p, c = vertex(view, v[2]) - p;
    const double la = length(a), lb = length(b), lc = length(c);
    sum += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

TEST(ClosestPoint, BoxHasItsClosedFormWithAndWithoutATree) {
  for (const bool search : {false, true}) {
    Options options;
    options.search = search;
    const Opened box(box_content(options));
    std::mt19937 random(1);
    for (int i = 0; i < 4000; ++i) {
      Vec3 p = random_point(random, 0.05);
      if (i % 4 == 0) p = {std::round(p.x / 0.015) * 0.015, std::round(p.y / 0.015) * 0.015, p.z};  // over vertices
      const Location found = closest_point(box.view, p);
      ASSERT_NEAR(found.signed_distance, box_distance(p), 2e-8) << p.x << " " << p.y << " " << p.z;
      ASSERT_NEAR(distance(p, found.point), std::fabs(found.signed_distance), 1e-12);
      ASSERT_LT(distance(found.point, position(box.view, found.at)), 1e-15);
      double sum = 0;
      for (const double b : found.at.bary) {
        ASSERT_GE(b, 0);
        sum += b;
      }
      ASSERT_NEAR(sum, 1, 1e-12);
    }
  }
}

// Triangles from 30 mm down to 0.3 um.
TEST(ClosestPoint, SideDoesNotDependOnTheSizeOfTheTriangles) {
  for (const double size : {1.0, 1e-3, 1e-5}) {
    ResponseFileContent content = box_content();
    for (auto& vertex : content.surface_vertices) {
      for (auto& x : vertex) x = static_cast<float>(size * x);
    }
    const Opened box(std::move(content));
    std::mt19937 random(3);
    for (int i = 0; i < 500; ++i) {
      const Vec3 p = random_point(random, 0.04);
      if (std::fabs(box_distance(p)) < 1e-4) continue;
      ASSERT_EQ(closest_point(box.view, size * p).signed_distance < 0, box_distance(p) < 0) << size << ' ' << i;
    }
  }
}

TEST(ClosestPoint, ConcaveBodiesAgreeWithBruteForceAndTheWindingNumber) {
  int inside = 0;
  for (const ConcaveShape& shape : concave_shapes()) {
    Options options;
    options.search = true;
    const Opened body(concave_content(shape, options));
    std::mt19937 random(2);
    BodyPoint near;
    for (int i = 0; i < 400; ++i) {
      Vec3 p = random_point(random, 0.03);
      p.z -= 0.01;
      const Location found = closest_point(body.view, p, near);
      near = found.at;
      ASSERT_NEAR(std::fabs(found.signed_distance), brute_force(body.view, p), 1e-12) << shape.name << ' ' << i;
      if (std::fabs(found.signed_distance) < 1e-9) continue;
      ASSERT_EQ(found.signed_distance < 0, winding_number(body.view, p) > 0.5) << shape.name << ' ' << i;
      inside += found.signed_distance < 0;
    }
  }
  EXPECT_GT(inside, 300);
}

TEST(ClosestPoint, ResultDoesNotDependOnWhereTheSearchBegins) {
  for (const bool search : {false, true}) {
    Options options;
    options.search = search;
    options.subdivision = 4;
    const Opened ball(ball_content(options));
    std::mt19937 random(4);
    Location last;
    for (unsigned i = 0; i < 3000; ++i) {
      Vec3 p = random_point(random, 0.05);
      if (i % 3 == 0) p = last.point + 1e-3 * p;  // near the last
      if (i % 9 == 0) p = last.point;             // on the surface
      if (i % 9 == 3) p = vertex(ball.view, i % ball.view.meta->vertex_count);  // several triangles tie
      const Location found = closest_point(ball.view, p);
      const BodyPoint anywhere{static_cast<std::uint32_t>(random() % ball.view.meta->triangle_count), {0.2, 0.3, 0.5}};
      for (const BodyPoint& near : {anywhere, last.at, found.at}) {
        const Location same = closest_point(ball.view, p, near);
        ASSERT_EQ(same.at.triangle, found.at.triangle) << i;
        for (int k = 0; k < 3; ++k) ASSERT_EQ(same.at.bary[k], found.at.bary[k]) << i;
        ASSERT_EQ(same.signed_distance, found.signed_distance) << i;
      }
      last = found;
    }
  }
}

TEST(ClosestPoint, TrianglesWithoutAreaAreTheirEdges) {
  ResponseFileContent content = box_content();
  const auto& t = content.surface_triangles[40];
  content.surface_vertices[t.vertices[0]] = content.surface_vertices[t.vertices[1]];
  const Opened box(std::move(content));
  std::mt19937 random(2);
  ClosestPointTracker<> tracker;
  BodyPoint near;
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random_point(random, 0.05);
    const Location found = closest_point(box.view, p), tracked = tracker.at(box.view, p, near);
    near = tracked.at;
    ASSERT_NEAR(std::fabs(found.signed_distance), brute_force(box.view, p), 1e-12);
    ASSERT_NEAR(tracked.signed_distance, std::fabs(found.signed_distance), 1e-12);
  }
}

TEST(ClosestPoint, ConditionSelectsTheNearestAcceptedPoint) {
  Options options;
  options.search = true;
  options.subdivision = 3;
  const Opened ball(ball_content(options));
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = random_point(random, 0.05);
    const auto upper = [](const Vec3& point) { return point.z > 0.01; };
    double least = HUGE_VAL;
    for (std::uint32_t t = 0; t < ball.view.meta->triangle_count; ++t) {
      const auto on = closest_on_triangle(ball.view, t, p, HUGE_VAL);
      if (upper(position(ball.view, {t, {on.bary[0], on.bary[1], on.bary[2]}}))) {
        least = std::min(least, std::sqrt(on.squared));
      }
    }
    Location found;
    ASSERT_TRUE(runtime::closest_point_where(ball.view, p, upper, HUGE_VAL, found));
    ASSERT_NEAR(std::fabs(found.signed_distance), least, 1e-12);
    EXPECT_TRUE(runtime::closest_point_where(ball.view, p, upper, 1.01 * least, found));
    EXPECT_FALSE(runtime::closest_point_where(ball.view, p, upper, 0.99 * least, found));
  }
}

struct Triangle {
  Vec3 corner[3];
};

// Sizes from a tenth of a millimetre to 0.1 m; heights down to `flat` times the length.
Triangle draw(std::mt19937& random, double flat) {
  const auto exponent = [&](double low) { return std::uniform_real_distribution<double>(low, 0)(random); };
  const double size = 0.1 * std::pow(10, exponent(-3)), height = size * std::pow(10, exponent(std::log10(flat)));
  const Vec3 along = random_direction(random), across = runtime::any_orthogonal(along);
  const Vec3 at = 0.05 * random_direction(random);
  const double share = std::uniform_real_distribution<double>(-0.5, 1.5)(random);
  return {{at, at + size * along, at + share * size * along + height * across}};
}

TEST(ClosestPoint, BoundExcludesNoTriangleThatIsNearer) {
  std::mt19937 random(7);
  int excluded = 0, plump = 0;
  for (int i = 0; i < 100000; ++i) {
    const bool sliver = i % 2 == 0;
    const Triangle t = draw(random, sliver ? 1e-9 : 0.1);
    const Vec3 p = t.corner[0] + std::pow(10, -1 - i % 6) * random_direction(random);
    const auto at = [&](double most) { return closest_on_triangle(p, t.corner[0], t.corner[1], t.corner[2], most); };
    const double squared = at(HUGE_VAL).squared;
    if (!sliver) {
      ASSERT_NEAR(std::sqrt(squared), plain_distance(p, t.corner[0], t.corner[1], t.corner[2]),
                  1e-10 * (1e-3 + std::sqrt(squared)))
          << i;
    }
    ASSERT_EQ(at((1 + 1e-6) * squared).squared, squared) << i;
    if (sliver) continue;
    ++plump;
    excluded += std::isinf(at(0.25 * squared).squared);
  }
  EXPECT_GT(excluded, 0.3 * plump);
}

TEST(ClosestPoint, CrowdedSurfaceHasTheSameDistancesThroughItsTree) {
  Options options;
  options.subdivision = 16;
  ResponseFileContent content = ball_content(options);
  for (std::size_t i = 0; i < content.surface_vertices.size(); ++i) {
    for (double& x : content.surface_vertices[i]) x *= std::pow(0.98, static_cast<double>(i));
  }
  const Opened plain(ResponseFileContent{content});
  add_search(content);
  const Opened searched(std::move(content));
  std::mt19937 random(8);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = std::pow(0.1, i % 5) * 0.05 * random_direction(random);
    ASSERT_EQ(std::fabs(closest_point(searched.view, p).signed_distance),
              std::fabs(closest_point(plain.view, p).signed_distance))
        << i;
  }
}

TEST(LocalClosestPoint, WalkOnAConvexBodyEndsAtTheClosestPoint) {
  Options options;
  options.subdivision = 4;
  options.search = true;
  const Opened ball(ball_content(options));
  std::mt19937 random(9);
  for (int i = 0; i < 500; ++i) {
    const Vec3 a = random_direction(random), b = random_direction(random);
    if (dot(a, b) < 0.5) continue;  // 60 degrees: some 20 triangles
    const Vec3 p = (1 + 0.3 * (i % 4) / 4.0) * kBallRadius * b;
    const Location found = local_closest_point(ball.view, closest_point(ball.view, kBallRadius * a).at, p);
    EXPECT_NEAR(found.signed_distance, closest_point(ball.view, p).signed_distance, 1e-9) << i;
  }
}

// Calls check(view, random) 300 times on each concave shape.
template <class Check>
void on_concave_bodies(unsigned seed, const Check& check) {
  for (const ConcaveShape& shape : concave_shapes()) {
    SCOPED_TRACE(shape.name);
    Options options;
    options.subdivision = 2;
    const Opened body(concave_content(shape, options));
    std::mt19937 random(seed);
    for (int i = 0; i < 300; ++i) check(body.view, random);
  }
}

BodyPoint random_place(const View& view, std::mt19937& random) {
  return {static_cast<std::uint32_t>(random() % view.meta->triangle_count), {0.2, 0.3, 0.5}};
}

TEST(LocalClosestPoint, OfTwoWalksTheNearerEndCounts) {
  on_concave_bodies(12, [](const View& view, std::mt19937& random) {
    const BodyPoint a = random_place(view, random), b = random() % 3 == 0 ? a : random_place(view, random);
    const Vec3 p = position(view, b) + 0.005 * random_direction(random);
    const double one = std::fabs(local_closest_point(view, a, p).signed_distance),
                 other = std::fabs(local_closest_point(view, b, p).signed_distance);
    ASSERT_EQ(local_closest_point(view, a, b, p).signed_distance, std::min(one, other));
  });
}

TEST(LocalClosestPoint, WalkNeverEndsFartherThanItBegan) {
  on_concave_bodies(10, [](const View& view, std::mt19937& random) {
    const BodyPoint start = random_place(view, random);
    const Vec3 p = position(view, start) + 0.01 * random_direction(random);
    const Location found = local_closest_point(view, start, p);
    ASSERT_LE(std::fabs(found.signed_distance), distance(p, position(view, start)) + 1e-15);
    ASSERT_GE(std::fabs(found.signed_distance), std::fabs(closest_point(view, p).signed_distance) - 1e-12);
  });
}

// Small steps stay within the tracker's ball, large ones leave it; kMost of 4 overflows at every vertex.
template <int kMost>
void follow(const View& view, const std::string& name) {
  std::mt19937 random(11);
  ClosestPointTracker<layout::feature_all, kMost> tracker;
  BodyPoint near;
  Vec3 p{0, 0, 0.02};
  for (int i = 0; i < 4000; ++i) {
    const double stride = i % 500 == 0 ? 0.02 : i % 7 == 0 ? 5e-4 : 2e-5;
    p = p + stride * random_direction(random);
    if (length(p) > 0.05) p = 0.02 * random_direction(random);
    const Location tracked = tracker.at(view, p, near), found = closest_point(view, p, tracked.at);
    ASSERT_NEAR(tracked.signed_distance, std::fabs(found.signed_distance), 1e-12) << name << ' ' << kMost << ' ' << i;
    ASSERT_NEAR(distance(tracked.point, p), tracked.signed_distance, 1e-12);
    near = tracked.at;
    if (i % 1000 == 999) tracker.reset();
  }
}

TEST(ClosestPointTracker, DistancesAreThoseOfTheSearch) {
  for (const bool search : {false, true}) {
    Options options;
    options.search = search;
    options.subdivision = 3;
    const Opened ball(ball_content(options)), box(box_content(options));
    follow<12>(ball.view, "ball");
    follow<4>(ball.view, "ball");
    follow<12>(box.view, "box");
    follow<4>(box.view, "box");
  }
  for (const ConcaveShape& shape : concave_shapes()) {
    Options options;
    options.search = true;
    const Opened body(concave_content(shape, options));
    follow<12>(body.view, shape.name);
    follow<4>(body.view, shape.name);
  }
}

TEST(Surface, PositionAndNormalAreTheSameFromBothSidesOfAnEdge) {
  Options options;
  options.subdivision = 3;
  const Opened ball(ball_content(options));
  for (std::uint32_t t = 0; t < ball.view.meta->triangle_count; ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      BodyPoint here{t, {0, 0, 0}};
      here.bary[(corner + 1) % 3] = 0.3;
      here.bary[(corner + 2) % 3] = 0.7;
      const BodyPoint there = across_edge(ball.view, here, corner);
      ASSERT_LT(distance(position(ball.view, here), position(ball.view, there)), 1e-15);
      ASSERT_LT(distance(smooth_normal(ball.view, here), smooth_normal(ball.view, there)), 1e-12);
      double weights[3], sum = 0;
      site_weights(ball.view, here, weights);
      for (const double w : weights) {
        ASSERT_GE(w, 0);
        sum += w;
      }
      ASSERT_NEAR(sum, 1, 1e-12);
    }
  }
}

}  // namespace
}  // namespace palpate::closest_point_test
