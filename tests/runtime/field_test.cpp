// SPDX-License-Identifier: GPL-3.0-or-later
// Blended fields against a plain evaluation of the specification; continuity, gradient, zero at the surface.
#include <array>
#include <cmath>

#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::BodyPoint;
using runtime::Field;
using runtime::FieldForce;
using runtime::ToolPoint;

using Matrix = std::array<std::array<double, 3>, 3>;

Vec3 times(const Matrix& m, const Vec3& v) {
  const double a[3] = {v.x, v.y, v.z};
  double r[3] = {0, 0, 0};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) r[i] += m[i][j] * a[j];
  }
  return {r[0], r[1], r[2]};
}

// Rodrigues: the rotation about from x to by the angle between them.
Matrix smallest_rotation(const Vec3& from, const Vec3& to) {
  const Vec3 axis = cross(from, to);
  const double c = dot(from, to), k = 1 / (1 + c);
  const double a[3] = {axis.x, axis.y, axis.z};
  const Matrix skew = {{{0, -axis.z, axis.y}, {axis.z, 0, -axis.x}, {-axis.y, axis.x, 0}}};
  Matrix m{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m[i][j] = (i == j ? c : 0) + skew[i][j] + k * a[i] * a[j];
  }
  return m;
}

Vec3 vec(const Triple& t) { return {t[0], t[1], t[2]}; }

// A curve at z, continued linearly in z beyond the depth scale by a difference quotient at its end.
double depth_curve(const std::vector<float>& c, double z) {
  const int n = static_cast<int>(c.size());
  const auto at = [&](double depth) { return spline::value(c.data(), n, std::sqrt(depth / kDepthScale)); };
  if (z <= kDepthScale) return at(z);
  const double h = 1e-6 * kDepthScale;
  return at(kDepthScale) + (z - kDepthScale) * (at(kDepthScale) - at(kDepthScale - h)) / h;
}

double sideways_curve(const std::vector<float>& c, double x) {
  const int n = static_cast<int>(c.size());
  const auto at = [&](double r) { return spline::value(c.data(), n, 0.5 * (r + 1)); };
  const double r = x / kSidewaysScale, h = 1e-7;
  if (r > 1) return at(1) + (r - 1) * (at(1) - at(1 - h)) / h;
  if (r < -1) return at(-1) + (r + 1) * (at(-1 + h) - at(-1)) / h;
  return at(r);
}

// Every response on its own, in its own carried frame, weighted and summed.
Vec3 plain_force(const ResponseFileContent& content, const BodyPoint& at, const std::vector<double>& tool_weights,
                 const Vec3& deflection) {
  const ResponseTriangle& t = content.surface_triangles[at.triangle];
  double weights[3] = {0, 0, 0};
  for (int k = 0; k < 3; ++k) {
    const double a = t.grid[k][0], b = t.grid[k][1];
    weights[0] += at.bary[k] * a / content.subdivision;
    weights[1] += at.bary[k] * b / content.subdivision;
    weights[2] += at.bary[k] * (content.subdivision - a - b) / content.subdivision;
  }
  Vec3 n;
  for (int i = 0; i < 3; ++i) n = n + weights[i] * vec(content.sites[content.patches[t.patch][i]].normal);
  n = unit(n, n);
  const double z = -dot(deflection, n);
  if (z <= 0) return {};
  Vec3 force;
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t index = content.patches[t.patch][i];
    const ResponseSite& site = content.sites[index];
    const Matrix carry = smallest_rotation(vec(site.normal), n);
    const Vec3 ux = times(carry, vec(site.tangent)), uy = cross(n, ux);
    const double x = dot(deflection, ux), y = dot(deflection, uy);
    for (std::size_t l = 0; l < tool_weights.size(); ++l) {
      const Response& r = content.responses[index * tool_weights.size() + l];
      double fx = depth_curve(r.lateral_x, z), fy = depth_curve(r.lateral_y, z);
      fx += std::fmax(0, depth_curve(r.growth_x, z)) * sideways_curve(r.sideways_x, x);
      fy += std::fmax(0, depth_curve(r.growth_y, z)) * sideways_curve(r.sideways_y, y);
      force = force + weights[i] * tool_weights[l] * (fx * ux + fy * uy + depth_curve(r.normal, z) * n);
    }
  }
  return force;
}

BodyPoint random_body_point(std::mt19937& random, const runtime::View& view) {
  std::uniform_real_distribution<double> unit(0, 1);
  double a = unit(random), b = unit(random);
  if (a + b > 1) {
    a = 1 - a;
    b = 1 - b;
  }
  return {static_cast<std::uint32_t>(random() % view.meta->triangle_count), {a, b, 1 - a - b}};
}

// At random places and depths down to `deepest` (m).
void compare_with_plain(ResponseFileContent content, double deepest) {
  const Opened ball(std::move(content));
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 3000; ++i) {
    const BodyPoint at = random_body_point(random, ball.view);
    const auto segment = static_cast<std::uint32_t>(random() % 3);
    const double w = unit(random);
    std::vector<double> tool_weights(4, 0);
    tool_weights[segment] = 1 - w;
    tool_weights[segment + 1] = w;
    const Field field(ball.view, 0, at, {segment, {1 - w, w, 0}});
    for (int k = 0; k < 2; ++k) {  // the second of a field that remembers the first
      const double z = deepest * unit(random);
      const Vec3 d = -z * field.normal() + 1.5 * kSidewaysScale * unit(random) * random_direction(random);
      const Vec3 expected = plain_force(ball.content, at, tool_weights, d);
      ASSERT_LT(distance(field.force(d).force, expected), 1e-5 * (1 + length(expected))) << i;
    }
  }
}

TEST(Field, MatchesThePlainEvaluation) {
  Options options;
  options.subdivision = 3;
  options.tools = Options::Tools::capsule;
  compare_with_plain(ball_content(options), 1.4 * kDepthScale);
}

// Of some responses the sideways stiffness falls towards the end of what was sampled: beyond it comes to nothing.
TEST(Field, AGrowthThatFallsIsNeverNegative) {
  Options options;
  options.tools = Options::Tools::capsule;
  ResponseFileContent content = ball_content(options);
  for (std::size_t i = 0; i < content.responses.size(); i += 3) {
    content.responses[i].growth_x = {0, 0.8F, 1, 0.9F, 0.7F};
    if (i % 2 == 0) content.responses[i].growth_y = {0, 1, 0, 0.2F, 0};
  }
  compare_with_plain(std::move(content), 4 * kDepthScale);
}

// A field remembers parts of its curves; its answers must not.
TEST(Field, AnswersAsIfAskedForTheFirstTime) {
  for (const int order : {0, 4}) {
    Options options;
    options.coupled = order;
    const Opened ball(ball_content(options));
    std::mt19937 random(18);
    std::uniform_real_distribution<double> unit(0, 1);
    const BodyPoint at{0, {0.5, 0.2, 0.3}};
    const Field asked(ball.view, 0, at, {});
    Vec3 d;
    for (int i = 0; i < 3000; ++i) {
      const bool jump = i % 10 == 0;
      if (jump) d = -1.2 * kDepthScale * unit(random) * asked.normal();
      if (!jump || i % 20 == 0) d = d + (jump ? 1.5 : 1e-4) * kSidewaysScale * random_direction(random);
      const FieldForce again = asked.force(d), first = Field(ball.view, 0, at, {}).force(d);
      ASSERT_LT(distance(again.force, first.force), 1e-13 * (1e-3 + length(first.force))) << order << " " << i;
      ASSERT_NEAR(again.limit, first.limit, 1e-13 * (1e-3 + first.limit));
    }
  }
}

TEST(Field, VanishesContinuouslyAtTheSurface) {
  const Opened ball(ball_content());
  std::mt19937 random(12);
  for (int i = 0; i < 200; ++i) {
    const Field field(ball.view, 0, random_body_point(random, ball.view), {});
    EXPECT_EQ(length(field.force(1e-3 * field.normal()).force), 0);
    EXPECT_EQ(length(field.force({0, 0, 0}).force), 0);
    double last = length(field.force(-1e-4 * field.normal()).force);
    for (double z = 1e-5; z > 1e-12; z /= 10) {
      const double force = length(field.force(-z * field.normal()).force);
      EXPECT_LT(force, last);
      last = force;
    }
    EXPECT_LT(last, 1e-8);
  }
}

// Seen from both sides of every edge of the contact surface, between patches too.
TEST(Field, IsTheSameFromBothSidesOfEveryEdge) {
  Options options;
  options.subdivision = 2;
  const Opened ball(ball_content(options));
  std::mt19937 random(13);
  for (std::uint32_t t = 0; t < ball.view.meta->triangle_count; ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      BodyPoint here{t, {0, 0, 0}};
      here.bary[(corner + 1) % 3] = 0.37;
      here.bary[(corner + 2) % 3] = 0.63;
      const BodyPoint there = runtime::cross_edge(ball.view, here, corner);
      const Field a(ball.view, 0, here, {}), b(ball.view, 0, there, {});
      const Vec3 d = -0.003 * a.normal() + 0.001 * random_direction(random);
      ASSERT_LT(distance(a.force(d).force, b.force(d).force), 1e-10);
      ASSERT_NEAR(a.force(d).limit, b.force(d).limit, 1e-10);
    }
  }
}

TEST(Field, SidewaysForceAtOneDepthIsAGradient) {
  const Opened ball(ball_content());
  std::mt19937 random(14);
  for (int i = 0; i < 20; ++i) {
    const Field field(ball.view, 0, random_body_point(random, ball.view), {});
    const runtime::DepthTerms terms = field.at_depth(0.004);
    const Vec3 x = unit(tangential(random_direction(random), field.normal()), {1, 0, 0});
    const Vec3 y = cross(field.normal(), x);
    // A closed loop, an ellipse off the middle; the trapezoidal rule is exact to round-off on it.
    constexpr int kSteps = 20000;
    double work = 0, gross = 0;
    const auto at = [&](int k) {
      const double a = 2 * std::numbers::pi * k / kSteps;
      return 0.0003 * x + 0.0008 * std::cos(a) * x + 0.0005 * std::sin(a) * y;
    };
    for (int k = 0; k < kSteps; ++k) {
      const Vec3 step = at(k + 1) - at(k);
      const double w = dot(0.5 * (field.sideways(terms, at(k)) + field.sideways(terms, at(k + 1))), step);
      work += w;
      gross += std::fabs(w);
    }
    EXPECT_LT(std::fabs(work), 1e-8 * gross);
    EXPECT_GT(gross, 1e-5);
  }
}

TEST(Field, ReportsCoverageAndDepthLimit) {
  const Opened ball(ball_content());
  // Response 3 is covered, its neighbours are not: at a site alone the share is 0 or 1.
  for (std::uint32_t t = 0; t < ball.view.meta->triangle_count; ++t) {
    for (int k = 0; k < 3; ++k) {
      BodyPoint at{t, {0, 0, 0}};
      at.bary[k] = 1;
      const std::uint32_t site = ball.view.triangles[t].site[k];
      const Field field(ball.view, 0, at, {});
      EXPECT_EQ(field.covered(), site % 7 == 3 ? 1 : 0);
      EXPECT_FLOAT_EQ(static_cast<float>(field.depth_limit()), ball.view.response_head(site).depth_limit);
      EXPECT_FALSE(field.force(-0.9 * field.depth_limit() * field.normal()).beyond);
      EXPECT_TRUE(field.force(-1.1 * field.depth_limit() * field.normal()).beyond);
    }
  }
}

// The limit is stored as a float, which lies a little below or above what was sampled.
TEST(Field, APushToTheSampledDepthIsNotBeyondIt) {
  for (const double depth : {0.005, 0.0047, 0.003, 0.0011}) {
    Options options = uniform();
    ResponseFileContent content = box_content(options);
    for (Response& r : content.responses) r.depth_limit = depth;
    const Opened box(std::move(content));
    const Field field(box.view, 0, {20, {0.3, 0.3, 0.4}}, {});
    EXPECT_FALSE(field.at_depth(depth).beyond) << depth;
    EXPECT_TRUE(field.at_depth(1.0001 * depth).beyond) << depth;
  }
}

TEST(Field, FrictionlessHasNoSidewaysForceAndNoLimit) {
  Options options = uniform();
  options.friction = options.lateral = false;
  const Opened box(box_content(options));
  const Field field(box.view, 0, {20, {0.3, 0.3, 0.4}}, {});
  const FieldForce f = field.force(-0.003 * field.normal() + 0.001 * cross(field.normal(), {0.6, 0.8, 0}));
  EXPECT_NEAR(f.normal, hertz(0.003), 1e-6);
  EXPECT_EQ(length(f.tangential), 0);
  EXPECT_TRUE(std::isinf(f.limit));
}

}  // namespace
}  // namespace palpate
