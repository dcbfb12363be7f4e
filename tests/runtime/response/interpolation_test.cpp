// SPDX-License-Identifier: GPL-3.0-or-later
// Blended responses against the specification; continuity over edges and patches; what a blend reports.
#include "palpate/response/interpolation.hpp"

#include <cmath>
#include <numbers>

#include "tests/runtime/response/plain_response.hpp"

namespace palpate::interpolation_test {
namespace {

using namespace test;
using runtime::BlendedResponse;
using runtime::BodyPoint;
using runtime::ToolPoint;
using runtime::View;

BlendedResponse<> blend(const View& view, const BodyPoint& at, const ToolPoint& on_tool = {}, const Vec3& x = {1, 0, 0}) {
  BlendedResponse<> response;
  response.blend(view, 0, at, on_tool, x, nullptr);
  return response;
}

BodyPoint random_body_point(std::mt19937& random, const View& view) {
  std::uniform_real_distribution<double> unit(0, 1);
  double a = unit(random), b = unit(random);
  if (a + b > 1) {
    a = 1 - a;
    b = 1 - b;
  }
  return {static_cast<std::uint32_t>(random() % view.meta->triangle_count), {a, b, 1 - a - b}};
}

// The basis of a blend does not matter, so it is drawn.
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
    const BlendedResponse<> response = blend(ball.view, at, {segment, {1 - w, w, 0}}, random_direction(random));
    const double z = deepest * unit(random);
    const Vec3 d = -z * response.normal() + 0.7 * kTangentialScale * unit(random) * random_direction(random);
    const Vec3 expected = plain_force(ball.content, at, tool_weights, d);
    ASSERT_LT(distance(response.force(d), expected), 1e-5 * (1 + length(expected))) << i;
  }
}

TEST(Interpolation, ForceIsThatOfTheSpecification) {
  Options options;
  options.subdivision = 3;
  options.tools = Options::Tools::capsule;
  for (const std::uint32_t bits : {8U, 12U, 16U}) {
    options.bits = bits;
    compare_with_plain(ball_content(options), 1.4 * kDepthScale);
  }
}

TEST(Interpolation, SpringsAndFrictionlessFilesAreThoseOfTheSpecification) {
  Options options;
  options.tools = Options::Tools::capsule;
  options.spring = true;
  compare_with_plain(ball_content(options), 1.4 * kDepthScale);
  options.spring = options.friction = false;
  compare_with_plain(ball_content(options), 1.4 * kDepthScale);
}

TEST(Interpolation, ForceVanishesContinuouslyAtTheSurface) {
  const Opened ball(ball_content());
  std::mt19937 random(12);
  for (int i = 0; i < 200; ++i) {
    const BlendedResponse<> response = blend(ball.view, random_body_point(random, ball.view));
    EXPECT_EQ(length(response.force(1e-3 * response.normal())), 0);
    EXPECT_EQ(length(response.force({0, 0, 0})), 0);
    double last = length(response.force(-1e-4 * response.normal()));
    for (double z = 1e-5; z > 1e-12; z /= 10) {
      const double force = length(response.force(-z * response.normal()));
      EXPECT_LT(force, last);
      last = force;
    }
    EXPECT_LT(last, 1e-8);
  }
}

TEST(Interpolation, BlendIsTheSameFromBothSidesOfEveryEdge) {
  for (const bool friction : {true, false}) {
    Options options;
    options.subdivision = 2;
    options.friction = friction;
    options.softening = friction;
    const Opened ball(ball_content(options));
    std::mt19937 random(13);
    for (std::uint32_t t = 0; t < ball.view.meta->triangle_count; ++t) {
      for (int corner = 0; corner < 3; ++corner) {
        BodyPoint here{t, {0, 0, 0}};
        here.bary[(corner + 1) % 3] = 0.37;
        here.bary[(corner + 2) % 3] = 0.63;
        const BodyPoint there = across_edge(ball.view, here, corner);
        const BlendedResponse<> a = blend(ball.view, here), b = blend(ball.view, there);
        const Vec3 d = -0.003 * a.normal() + 0.001 * random_direction(random);
        ASSERT_LT(distance(a.force(d), b.force(d)), 1e-10);
        ASSERT_NEAR(a.softening(), b.softening(), 1e-12);
        ASSERT_NEAR(a.depth_limit(), b.depth_limit(), 1e-12);
        ASSERT_NEAR(a.law().at(0.003).friction_coefficient, b.law().at(0.003).friction_coefficient, 1e-12);
      }
    }
  }
}

TEST(Interpolation, TangentialForceAtOneDepthIsAGradient) {
  const Opened ball(ball_content());
  std::mt19937 random(14);
  for (int i = 0; i < 20; ++i) {
    const BlendedResponse<> response = blend(ball.view, random_body_point(random, ball.view));
    const Vec3 &n = response.normal(), &x = response.basis_x(), &y = response.basis_y();
    EXPECT_NEAR(dot(x, n) + dot(y, n) + dot(x, y), 0, 1e-14);
    // A closed loop, an ellipse off the middle, on which the trapezoidal rule is exact to round-off.
    constexpr int kSteps = 2000;
    double work = 0, gross = 0;
    const auto at = [&](int k) {
      const double a = 2 * std::numbers::pi * k / kSteps;
      return 0.0003 * x + 0.0008 * std::cos(a) * x + 0.0005 * std::sin(a) * y;
    };
    for (int k = 0; k < kSteps; ++k) {
      const Vec3 step = at(k + 1) - at(k);
      const Vec3 force = 0.5 * (response.force(at(k) - 0.004 * n) + response.force(at(k + 1) - 0.004 * n));
      work += dot(force, step);
      gross += std::fabs(dot(force, step));
    }
    EXPECT_LT(std::fabs(work), 1e-8 * gross);
    EXPECT_GT(gross, 1e-6);
  }
}

TEST(Interpolation, FilledShareAndDepthLimitAreThoseOfTheSites) {
  const Opened ball(ball_content());
  for (std::uint32_t t = 0; t < ball.view.meta->triangle_count; ++t) {
    for (int k = 0; k < 3; ++k) {
      BodyPoint at{t, {0, 0, 0}};
      at.bary[k] = 1;
      const std::uint32_t site = ball.view.triangle(t).site[k];
      const BlendedResponse<> response = blend(ball.view, at);
      EXPECT_EQ(response.filled_share(), site % 7 == 3 ? 1 : 0);
      EXPECT_FLOAT_EQ(static_cast<float>(response.depth_limit()), ball.view.response_head(site).depth_limit);
    }
  }
}

TEST(Interpolation, SofteningIsBlendedByTheSitesWeights) {
  Options options;
  options.softening = true;
  const Opened ball(ball_content(options));
  for (std::uint32_t t = 0; t < 20; ++t) {
    const BodyPoint at{t, {0.2, 0.3, 0.5}};
    double expected = 0;
    for (int k = 0; k < 3; ++k) expected += at.bary[k] * ball.view.softening(ball.view.triangle(t).site[k]);
    EXPECT_NEAR(blend(ball.view, at).softening(), expected, 1e-9);
  }
}

TEST(Interpolation, FrictionlessFileHasNoTangentialStiffness) {
  const Opened box(box_content(flat(false)));
  const BlendedResponse<> response = blend(box.view, {20, {0.3, 0.3, 0.4}});
  EXPECT_FALSE(response.law().has_friction());
  const Vec3 n = response.normal(), f = response.force(-0.003 * n + 0.001 * response.basis_x());
  EXPECT_NEAR(dot(f, n), hertz(0.003), 1e-4);
  EXPECT_LT(length(tangential(f, n)), 1e-12);
}

TEST(Interpolation, BlendOverAUsedResponseIsThatOfANewOne) {
  Options options;
  options.tools = Options::Tools::all;
  options.softening = true;
  const Opened box(box_content(options));
  std::mt19937 random(15);
  BlendedResponse<> used;
  for (int i = 0; i < 2000; ++i) {
    const std::uint32_t tool = static_cast<std::uint32_t>(random() % 3);
    const layout::ToolRecord& record = box.view.tools[tool];
    const ToolPoint on_tool{record.first_patch + static_cast<std::uint32_t>(random() % record.patch_count), {0.2, 0.3, 0.5}};
    const BodyPoint at = random_body_point(random, box.view);
    const Vec3 x = random_direction(random);
    BlendedResponse<> fresh;
    used.blend(box.view, tool, at, on_tool, x, nullptr);
    fresh.blend(box.view, tool, at, on_tool, x, nullptr);
    const Vec3 d = -0.002 * fresh.normal() + 5e-4 * random_direction(random);
    ASSERT_EQ(distance(used.force(d), fresh.force(d)), 0) << i;
    ASSERT_EQ(used.softening(), fresh.softening());
  }
}

}  // namespace
}  // namespace palpate::interpolation_test
