// SPDX-License-Identifier: GPL-3.0-or-later
// Tools that are not round about the normal of their contact: samples of the spin, and what lies between them.
#include <numbers>

#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::BodyPoint;
using runtime::Contact;
using runtime::EnergyMeter;
using runtime::Field;
using runtime::Spin;
using runtime::ToolPoint;
using runtime::View;

constexpr double kCircle = 2 * std::numbers::pi;

Options spun(int spins, int coupled = 0) {
  Options options;
  options.tools = Options::Tools::all;
  options.spins = spins;
  options.coupled = coupled;
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

/// A corner of the contact surface that is one site alone (subdivision 1), and the tool's points that have spins.
struct Pair {
  std::uint32_t tool;
  ToolPoint on_tool;
  layout::ToolVertexRecord vertex;
};

std::vector<Pair> pairs(const View& view) {
  std::vector<Pair> all;
  for (std::uint32_t tool = 0; tool < view.meta->tool_count; ++tool) {
    const layout::ToolRecord& record = view.tools[tool];
    for (std::uint32_t p = record.first_patch; p < record.first_patch + record.patch_count; ++p) {
      for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t vertex = view.tool_patches[p].vertex[corner];
        if (view.spins[vertex] < 2) continue;
        ToolPoint at{p, {0, 0, 0}};
        at.weights[corner] = 1;
        all.push_back({tool, at, view.tool_vertices[vertex]});
      }
    }
  }
  return all;
}

/// The x axis of a site's frame at a point with normal n.
Vec3 carried_x(const layout::Site& site, const Vec3& n) {
  const Vec3 x = runtime::any_orthogonal(n), y = cross(n, x);
  const runtime::Across carried = runtime::carried_axis(site, n, x, y);
  return carried.cosine * x + carried.sine * y;
}

Vec3 aside(const Vec3& n, const Vec3& x, double angle) {
  return 0.0008 * std::cos(angle) * x + 0.0008 * std::sin(angle) * cross(n, x) - 0.002 * n;
}

TEST(Spin, ASampleAnswersAsItWasBaked) {
  for (const int coupled : {0, 2, 4}) {
    const Opened ball(ball_content(spun(5, coupled)));
    int asked = 0;
    for (const Pair& pair : pairs(ball.view)) {
      for (std::uint32_t triangle = 0; triangle < 40; triangle += 7) {
        const BodyPoint at{triangle, {1, 0, 0}};
        const std::uint32_t site = ball.view.triangles[triangle].site[0];
        const Vec3 n = normal(ball.view, at), x = carried_x(ball.view.sites[site], n);
        for (std::uint32_t k = 0; k < 5; ++k) {
          // Of a profile the pose is that of a vertex whose normal is the contact's: as the runtime would find it.
          const Pose pose = laid(pair.vertex, n, x, kCircle * k / 5);
          const Vec3 d = aside(n, x, 0.4 * k);
          const Vec3 turned = Field(ball.view, pair.tool, at, pair.on_tool, {&pose, 0}).force(d).force;
          const Vec3 baked = Field(ball.view, pair.tool, at, pair.on_tool, {nullptr, k}).force(d).force;
          ASSERT_LT(distance(turned, baked), 1e-6 * length(baked)) << pair.tool << ' ' << triangle << ' ' << k;
          asked += length(baked) > 0.1;
        }
      }
    }
    EXPECT_GT(asked, 500);
  }
}

// On a body that answers alike everywhere and in every direction a quarter of a turn changes the sign of the stiffness'
// second harmonic, which the tool brings along: between the spins it turns.
TEST(Spin, WhatTheToolBringsAlongTurnsWithIt) {
  Options options = spun(4, 2);
  options.uniform = true;
  ResponseFileContent content = box_content(options);
  const std::size_t vertices = content.tool_vertex_count();
  const coupled::Places places = coupled::places(*content.coupled);
  std::vector<int> number;
  for (const ResponseTool& tool : content.tools) {
    for (const ResponseToolVertex& v : tool.vertices) number.push_back(v.spins > 0 ? 0 : number.back() + 1);
  }
  for (std::size_t i = 0; i < content.responses.size(); ++i) {
    std::vector<std::int16_t>& c = content.responses[i].coupled;
    for (int k = places.stiffness; number[i % vertices] % 2 == 1 && k < places.cubic; ++k) {
      if ((k - places.stiffness) % 3 > 0)
        c[static_cast<std::size_t>(k)] = static_cast<std::int16_t>(-c[static_cast<std::size_t>(k)]);
    }
  }
  {
    const Opened box(std::move(content));
    const Pair pair = pairs(box.view).back();
    const BodyPoint at{2, {0.3, 0.3, 0.4}};
    const Vec3 n = normal(box.view, at), x = runtime::any_orthogonal(n), y = cross(n, x);
    const Pose straight = laid(pair.vertex, n, x, 0);
    const Vec3 before = Field(box.view, pair.tool, at, pair.on_tool, {&straight, 0}).force(aside(n, x, 0.3)).force;
    for (double spin = 0; spin < kCircle; spin += 0.05) {
      const Pose pose = laid(pair.vertex, n, x, spin);
      const Vec3 force = Field(box.view, pair.tool, at, pair.on_tool, {&pose, 0}).force(aside(n, x, 0.3 + spin)).force;
      const Vec3 along = std::cos(spin) * x + std::sin(spin) * y;
      EXPECT_NEAR(dot(force, along), dot(before, x), 1e-6);
      EXPECT_NEAR(dot(force, cross(n, along)), dot(before, y), 1e-6);
      EXPECT_NEAR(dot(force, n), dot(before, n), 1e-6);
    }
  }
}

TEST(Spin, IsPeriodicAndWithoutAStep) {
  for (const int coupled : {0, 4}) {
    const Opened ball(ball_content(spun(5, coupled)));
    for (const Pair& pair : pairs(ball.view)) {
      const BodyPoint at{11, {0.2, 0.5, 0.3}};
      const Vec3 n = normal(ball.view, at), x = runtime::any_orthogonal(n);
      const auto force = [&](double angle) {
        const Pose pose = laid(pair.vertex, n, x, angle);
        return Field(ball.view, pair.tool, at, pair.on_tool, {&pose, 0}).force(aside(n, x, 1)).force;
      };
      constexpr int kSteps = 2000;
      double moved = 0, steepest = 0;
      for (int i = 0; i < kSteps; ++i) {
        const double step = distance(force(kCircle * i / kSteps), force(kCircle * (i + 1) / kSteps));
        moved += step;
        steepest = std::max(steepest, step);
      }
      EXPECT_GT(moved, 0.05);
      EXPECT_LT(steepest, 2.0 * kCircle / kSteps);  // 2 N a radian at a force of some 0.6 N
      EXPECT_LT(distance(force(0.7), force(0.7 + kCircle)), 1e-9);
      EXPECT_LT(distance(force(-1e-18), force(0)), 1e-9);
    }
  }
}

// Any turns of a tool that touches, with its handle into the body as well: the pole and the direction that is lost
// there make no step.
TEST(Spin, RandomTurnsMakeNoStep) {
  const Opened ball(ball_content(spun(6)));
  const BodyPoint at{23, {0.3, 0.6, 0.1}};
  const Vec3 n = normal(ball.view, at), x = runtime::any_orthogonal(n);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> draw(0, 1);
  const layout::ToolRecord& rod = ball.view.tools[1];
  const auto force = [&](std::uint32_t tool, const ToolPoint& on_tool, const Pose& pose) {
    ToolPoint there = on_tool;
    if (tool == 1) {
      const double along = on_tool.weights[0] * kStemLength;
      there = runtime::profile_point(ball.view, rod, runtime::profile_meridian(rod, along, pose.along_axis(n)));
    }
    return Field(ball.view, tool, at, there, {&pose, 0}).force(aside(n, x, 2)).force;
  };
  constexpr double kTurned = 1e-5;
  double steepest[3] = {};
  for (int i = 0; i < 60000; ++i) {
    const std::uint32_t tool = 1 + i % 2;
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
    if (tool == 1 && i % 4 < 2) on_tool.weights[0] = 0;  // the tip's cap, not the stem
    const double step = distance(force(tool, on_tool, pose), force(tool, on_tool, next)) / kTurned;
    steepest[tool] = std::max(steepest[tool], step);
  }
  EXPECT_GT(steepest[1], 0.05);
  EXPECT_LT(steepest[1], 6.0);  // N a radian
  EXPECT_LT(steepest[2], 6.0);
}

// p may lag behind on the tip when the tool is upright already: the direction in which it lies turns round at the pole.
TEST(Spin, ATipThatLagsBehindPassesThePoleWithoutAStep) {
  const Opened ball(ball_content(spun(6)));
  const BodyPoint at{23, {0.3, 0.6, 0.1}};
  const Vec3 n = normal(ball.view, at), x = runtime::any_orthogonal(n);
  const layout::ToolRecord& rod = ball.view.tools[1];
  const Pose up = laid(ball.view.tool_vertices[rod.first_vertex], n, x, 0);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> draw(0, 1);
  constexpr double kTurned = 1e-5, kRuns = 3;
  double steepest[2] = {};
  for (int i = 0; i < 20000; ++i) {
    const double angle = 0.1 + 1.4 * draw(random), way = kCircle * draw(random), tilt = draw(random);
    const ToolPoint on_tool = runtime::profile_point(ball.view, rod, angle * kTipRadius);
    const Pose pose = turned(0.2 * tilt * tilt * tilt, std::cos(way) * x + std::sin(way) * cross(n, x), {}) * up;
    const Pose next = turned(kTurned, random_direction(random), {}) * pose;
    for (int k = 0; k < 2; ++k) {
      const double sure = k == 0 ? kRuns / angle : HUGE_VAL;
      const auto force = [&](const Pose& to) {
        return Field(ball.view, 1, at, on_tool, {&to, 0, sure}).force(aside(n, x, 2)).force;
      };
      steepest[k] = std::max(steepest[k], distance(force(pose), force(next)) / kTurned);
    }
  }
  EXPECT_LT(steepest[0], kRuns * 6.0);  // N a radian
  EXPECT_GT(steepest[1], 1000.0) << "sure of it everywhere";
}

// A stem lies on the box, is pushed aside without slipping, and turned where it lies.
TEST(Spin, AStemThatIsTwistedWhereItSticksFollowsWithoutAStep) {
  for (const int coupled : {0, 2}) {
    const Opened box(box_content(spun(6, coupled)));
    Contact contact(box.view, 1);
    EnergyMeter meter;
    const auto lie = [&](double depth, double shift, double angle) {
      // It touches with the end that it is turned about.
      const Vec3 along{std::cos(angle), std::sin(angle), 0};
      const Vec3 y = cross({0, 0, 1}, along);
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
      ASSERT_TRUE(t.state == State::stick || t.state == State::slide);
      ASSERT_LT(distance(t.force, last), 4e-3) << angle;  // 4 N a radian
      last = t.force;
      if (distance(last, first) > distance(farthest, first)) farthest = last;
    }
    EXPECT_GT(distance(farthest, first), 0.02);
    for (double z = 0.002; z > -1e-3; z -= 2e-6) t = lie(z, 1e-4, 0);
    EXPECT_EQ(length(t.force), 0);
    EXPECT_GE(meter.given() - meter.returned(), -1e-9);
  }
}

// A tool that is round about its contact's normal has one spin: the same force however it is turned, and the same as
// in a file without spins.
TEST(Spin, IsNothingToARoundTool) {
  Options without = spun(1);
  const Opened plain(ball_content(without)), spins(ball_content(spun(4)));
  EXPECT_EQ(plain.view.spins, nullptr);
  const BodyPoint at{5, {0.2, 0.2, 0.6}};
  const Vec3 n = normal(spins.view, at), x = runtime::any_orthogonal(n);
  const Pose pose = turned(1, n, {});
  for (const std::uint32_t tool : {0u, 1u}) {
    const ToolPoint tip{spins.view.tools[tool].first_patch, {1, 0, 0}};
    EXPECT_EQ(spins.view.spins[spins.view.tools[tool].first_vertex], 1u);
    const Vec3 still = Field(spins.view, tool, at, tip).force(aside(n, x, 1)).force;
    EXPECT_EQ(distance(Field(spins.view, tool, at, tip, {&pose, 0}).force(aside(n, x, 1)).force, still), 0);
  }
}

// Grasps are of the spin at which they were taken.
TEST(Spin, AGraspIsOfItsSpin) {
  Options options = spun(5);
  options.tools = Options::Tools::mesh;
  options.grasp = options.turn = true;
  const Opened ball(ball_content(options));
  const Pair pair = pairs(ball.view).front();
  const BodyPoint at{0, {1, 0, 0}};
  const std::uint32_t site = ball.view.triangles[0].site[0];
  const Vec3 n = normal(ball.view, at), x = carried_x(ball.view.sites[site], n);
  for (std::uint32_t k = 0; k < 5; ++k) {
    const Pose pose = laid(pair.vertex, n, x, kCircle * k / 5);
    const runtime::TurnField turned(ball.view, 0, at, pair.on_tool, {&pose, 0});
    const runtime::TurnField baked(ball.view, 0, at, pair.on_tool, {nullptr, k});
    const auto a = turned.answer(aside(n, x, 1), {0.1, 0.05, -0.1}),
               b = baked.answer(aside(n, x, 1), {0.1, 0.05, -0.1});
    EXPECT_LT(distance(a.force.force, b.force.force), 1e-6 * length(b.force.force));
    EXPECT_LT(distance(a.torque, b.torque), 1e-6 * length(b.torque));
    if (k > 0) {
      const runtime::TurnField first(ball.view, 0, at, pair.on_tool);
      EXPECT_GT(distance(first.answer(aside(n, x, 1), {}).force.force, b.force.force), 1e-3);
    }
  }
}

}  // namespace
}  // namespace palpate
