// SPDX-License-Identifier: GPL-3.0-or-later
// Tools that are not round about the normal of their contact: sampled spins, and the blend between them.
#include "palpate/response/orientation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/runtime/response/plain_response.hpp"

namespace palpate::orientation_test {
namespace {

using namespace test;
using runtime::BlendedResponse;
using runtime::BodyPoint;
using runtime::Contact;
using runtime::EnergyMeter;
using runtime::ToolPoint;
using runtime::View;

constexpr double kCircle = 2 * std::numbers::pi;

Options spun(int spins) {
  Options options;
  options.tools = Options::Tools::all;
  options.spins = spins;
  return options;
}

Vec3 vec(const float (&v)[3]) { return runtime::to_vec(v); }

/// The pose, but for its place, that lays a vertex' tangent at an angle (rad) about n from x, its normal against n.
Pose laid(const layout::ToolVertexRecord& vertex, const Vec3& n, const Vec3& x, double angle) {
  const Vec3 t = vec(vertex.tangent), m = vec(vertex.normal), b = cross(m, t);
  const Vec3 y = cross(n, x), to = std::cos(angle) * x + std::sin(angle) * y, side = cross(-n, to);
  Pose pose;
  const double from[3][3] = {{t.x, t.y, t.z}, {b.x, b.y, b.z}, {m.x, m.y, m.z}};
  const double into[3][3] = {{to.x, to.y, to.z}, {side.x, side.y, side.z}, {-n.x, -n.y, -n.z}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      pose.rotation[3 * i + j] = 0;
      for (int k = 0; k < 3; ++k) pose.rotation[3 * i + j] += into[k][i] * from[k][j];
    }
  }
  return pose;
}

/// A vertex of a tool that has several spins.
struct SpunVertex {
  std::uint32_t tool;
  ToolPoint on_tool;
  std::uint32_t index;
  layout::ToolVertexRecord vertex;
};

std::vector<SpunVertex> spun_vertices(const View& view) {
  std::vector<SpunVertex> all;
  for (std::uint32_t tool = 0; tool < view.meta->tool_count; ++tool) {
    const layout::ToolRecord& record = view.tools[tool];
    for (std::uint32_t p = record.first_patch; p < record.first_patch + record.patch_count; ++p) {
      for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t vertex = view.tool_patches[p].vertex[corner];
        if (view.spins[vertex] < 2) continue;
        ToolPoint at{p, {0, 0, 0}};
        at.weights[corner] = 1;
        all.push_back({tool, at, vertex, view.tool_vertices[vertex]});
      }
    }
  }
  return all;
}

Vec3 force(const View& view, const SpunVertex& v, const BodyPoint& at, const Pose& pose, const Vec3& d) {
  BlendedResponse<> response;
  response.blend(view, v.tool, at, v.on_tool, {1, 0, 0}, &pose);
  return response.force(d);
}

Vec3 aside(const Vec3& n, const Vec3& x, double angle) {
  return 0.0008 * std::cos(angle) * x + 0.0008 * std::sin(angle) * cross(n, x) - 0.002 * n;
}

TEST(Orientation, SampledSpinHasItsOwnResponse) {
  const Opened ball(ball_content(spun(5)));
  int compared = 0;
  for (const SpunVertex& v : spun_vertices(ball.view)) {
    for (std::uint32_t triangle = 0; triangle < 40; triangle += 7) {
      const BodyPoint at{triangle, {1, 0, 0}};
      const std::uint32_t site = ball.view.triangle(triangle).site[0];
      const Vec3 n = smooth_normal(ball.view, at);
      const Vec3 x = rotated(vec(ball.view.sites[site].tangent), vec(ball.view.sites[site].normal), n), y = cross(n, x);
      for (std::uint32_t k = 0; k < 5; ++k) {
        const Vec3 d = aside(n, x, 0.4 * k);
        const Response& own = ball.content.responses[layout::response_index(*ball.view.meta, site, v.index) + k];
        const Vec3 f = PlainResponse(ball.content, own).force(-dot(d, n), dot(d, x), dot(d, y));
        const Vec3 baked = f.x * x + f.y * y + f.z * n;
        const Vec3 turned = force(ball.view, v, at, laid(v.vertex, n, x, kCircle * k / 5), d);
        ASSERT_LT(distance(turned, baked), 1e-5 * length(baked)) << v.tool << ' ' << triangle << ' ' << k;
        compared += length(baked) > 0.1;
      }
    }
  }
  EXPECT_GT(compared, 500);
}

// On a body with one isotropic response the second harmonic of the stiffness turns with the tool, between the spins too.
TEST(Orientation, AnisotropyTurnsWithTheTool) {
  Options options = spun(4);
  options.uniform = true;
  ResponseFileContent content = box_content(options);
  const std::size_t vertices = content.tool_vertex_count();
  const response::Offsets o = response::offsets(content.degrees);
  std::vector<int> number;
  for (const ResponseTool& tool : content.tools) {
    for (const ResponseToolVertex& v : tool.vertices) number.push_back(v.spins > 0 ? 0 : number.back() + 1);
  }
  for (std::size_t i = 0; i < content.responses.size(); ++i) {
    std::vector<std::int16_t>& c = content.responses[i].coefficients;
    for (int k = o.stiffness; number[i % vertices] % 2 == 1 && k < o.friction; ++k) {
      const auto at = static_cast<std::size_t>(k);
      if ((k - o.stiffness) % 3 > 0) c[at] = static_cast<std::int16_t>(-c[at]);
    }
  }
  const Opened box(std::move(content));
  const SpunVertex v = spun_vertices(box.view).back();
  const BodyPoint at{2, {0.3, 0.3, 0.4}};
  const Vec3 n = smooth_normal(box.view, at), x = runtime::any_orthogonal(n), y = cross(n, x);
  const Vec3 before = force(box.view, v, at, laid(v.vertex, n, x, 0), aside(n, x, 0.3));
  for (double spin = 0; spin < kCircle; spin += 0.05) {
    const Vec3 f = force(box.view, v, at, laid(v.vertex, n, x, spin), aside(n, x, 0.3 + spin));
    const Vec3 along = std::cos(spin) * x + std::sin(spin) * y;
    EXPECT_NEAR(dot(f, along), dot(before, x), 1e-6);
    EXPECT_NEAR(dot(f, cross(n, along)), dot(before, y), 1e-6);
    EXPECT_NEAR(dot(f, n), dot(before, n), 1e-6);
  }
}

TEST(Orientation, ForceIsPeriodicAndContinuousInTheSpin) {
  const Opened ball(ball_content(spun(5)));
  for (const SpunVertex& v : spun_vertices(ball.view)) {
    const BodyPoint at{11, {0.2, 0.5, 0.3}};
    const Vec3 n = smooth_normal(ball.view, at), x = runtime::any_orthogonal(n);
    const auto spin = [&](double angle) { return force(ball.view, v, at, laid(v.vertex, n, x, angle), aside(n, x, 1)); };
    constexpr int kSteps = 1000;
    double moved = 0, steepest = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double step = distance(spin(kCircle * i / kSteps), spin(kCircle * (i + 1) / kSteps));
      moved += step;
      steepest = std::max(steepest, step);
    }
    EXPECT_GT(moved, 0.05);
    EXPECT_LT(steepest, 2.0 * kCircle / kSteps);  // 2 N a radian at a force of some 0.6 N
    EXPECT_LT(distance(spin(0.7), spin(0.7 + kCircle)), 1e-9);
    EXPECT_LT(distance(spin(-1e-18), spin(0)), 1e-9);
  }
}

// Any turns, with the handle into the body as well: the direction is lost at a pole without a step.
TEST(Orientation, RandomTurnsChangeTheForceContinuously) {
  const Opened ball(ball_content(spun(6)));
  const BodyPoint at{23, {0.3, 0.6, 0.1}};
  const Vec3 n = smooth_normal(ball.view, at), x = runtime::any_orthogonal(n);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> draw(0, 1);
  const layout::ToolRecord& rod = ball.view.tools[1];
  const runtime::ToolShape<> shape(ball.view, 1);
  constexpr double kTurned = 1e-5;
  double steepest[3] = {};
  for (int i = 0; i < 60000; ++i) {
    const std::uint32_t tool = 1 + static_cast<std::uint32_t>(i % 2);
    // One in three near the pole, one in three with the handle straight into the body.
    const double tilt = i % 3 == 0   ? draw(random) * 3.14
                        : i % 3 == 1 ? 1e-3 * draw(random)
                                     : 3.14159 - 1e-3 * draw(random);
    const double way = kCircle * draw(random);
    const Vec3 axis = std::cos(way) * x + std::sin(way) * cross(n, x);
    const Pose up = laid(ball.view.tool_vertices[rod.first_vertex], n, x, kCircle * draw(random));
    const Pose pose = turned(tilt, axis, {}) * up, next = turned(kTurned, random_direction(random), {}) * pose;
    ToolPoint on_tool{ball.view.tools[2].first_patch + static_cast<std::uint32_t>(random() % 8), {0, 0, 0}};
    for (double& w : on_tool.weights) w = draw(random);
    const double sum = on_tool.weights[0] + on_tool.weights[1] + on_tool.weights[2];
    for (double& w : on_tool.weights) w /= sum;
    const double along = i % 4 < 2 ? 0 : on_tool.weights[0] * kStemLength;
    const auto at_pose = [&](const Pose& p) {
      BlendedResponse<> response;
      const ToolPoint there = tool == 1 ? shape.sampled_point({{0, 0, along}, {}}, p, n) : on_tool;
      response.blend(ball.view, tool, at, there, {1, 0, 0}, &p);
      return response.force(aside(n, x, 2));
    };
    steepest[tool] = std::max(steepest[tool], distance(at_pose(pose), at_pose(next)) / kTurned);
  }
  EXPECT_GT(steepest[1], 0.05);
  EXPECT_LT(steepest[1], 6.0);  // N a radian
  EXPECT_LT(steepest[2], 6.0);
}

// A stem lies on the box, is pushed aside without slipping, and turned where it lies.
TEST(Orientation, TwistedStickingStemHasNoStepAndGivesNoEnergy) {
  const Opened box(box_content(spun(6)));
  Contact contact(box.view, 1);
  EnergyMeter meter;
  const auto lie = [&](double depth, double shift, double angle) {
    // The end about which the stem turns touches.
    const Vec3 along{std::cos(angle), std::sin(angle), 0}, y = cross({0, 0, 1}, along);
    const Pose pose{{0, -y.x, along.x, 0, -y.y, along.y, 1, 0, 0}, {shift, 0, kTop + kTipRadius - depth}};
    const Tick tick = contact.tick(pose);
    meter.add(pose, tick);
    return tick;
  };
  Tick t;
  for (double z = -1e-4; z < 0.002; z += 2e-6) t = lie(z, 0, 0);
  for (double e = 0; e < 1e-4; e += 1e-6) t = lie(0.002, e, 0);
  ASSERT_EQ(t.state, State::stick);
  Vec3 last = t.force, first = t.force, farthest = t.force;
  for (double angle = 0; angle < 2 * kCircle; angle += 1e-3) {
    t = lie(0.002, 1e-4, angle);
    ASSERT_TRUE(t.touches());
    ASSERT_LT(distance(t.force, last), 4e-3) << angle;  // 4 N a radian
    last = t.force;
    if (distance(last, first) > distance(farthest, first)) farthest = last;
  }
  EXPECT_GT(distance(farthest, first), 0.02);
  for (double z = 0.002; z > -1e-3; z -= 2e-6) t = lie(z, 1e-4, 0);
  EXPECT_EQ(length(t.force), 0);
  EXPECT_GE(meter.given() - meter.returned(), -1e-9);
}

TEST(Orientation, RoundToolHasOneSpin) {
  const Opened spins(ball_content(spun(4)));
  EXPECT_EQ(Opened(ball_content(spun(1))).view.spins, nullptr);
  const BodyPoint at{5, {0.2, 0.2, 0.6}};
  const Vec3 n = smooth_normal(spins.view, at), x = runtime::any_orthogonal(n);
  const Pose pose = turned(1, n, {});
  for (const std::uint32_t tool : {0u, 1u}) {
    const ToolPoint tip{spins.view.tools[tool].first_patch, {1, 0, 0}};
    EXPECT_EQ(spins.view.spins[spins.view.tools[tool].first_vertex], 1u);
    BlendedResponse<> still, spinning;
    still.blend(spins.view, tool, at, tip, {1, 0, 0}, nullptr);
    spinning.blend(spins.view, tool, at, tip, {1, 0, 0}, &pose);
    EXPECT_EQ(distance(still.force(aside(n, x, 1)), spinning.force(aside(n, x, 1))), 0);
  }
}

}  // namespace
}  // namespace palpate::orientation_test
