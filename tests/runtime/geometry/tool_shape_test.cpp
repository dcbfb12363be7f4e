// SPDX-License-Identifier: GPL-3.0-or-later
// Tools as sphere-swept cores: the nearest core point, the safe distance, how a contact's point runs over the core.
#include "palpate/geometry/tool_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/runtime/support.hpp"

namespace palpate::tool_shape_test {
namespace {

using namespace test;
using runtime::closest_point;
using runtime::CorePoint;
using runtime::ToolPoint;
using runtime::ToolShape;
using runtime::ToolTouch;
using runtime::View;

constexpr double kPi = std::numbers::pi;

// The tool's z axis leans by `angle` from vertical towards +x.
Pose leaning(double angle, const Vec3& at) { return turned(angle, {0, 1, 0}, at); }

Options with(Options::Tools tools) {
  Options options;
  options.tools = tools;
  return options;
}

// Points of the axis, or of the grids over a mesh tool's patches.
std::vector<Vec3> core_points(const View& view, const layout::ToolRecord& tool) {
  std::vector<Vec3> points;
  if (tool.kind != static_cast<std::uint32_t>(layout::ToolKind::mesh)) {
    for (int k = 0; k <= 8; ++k) points.push_back({0, 0, 0.125 * k * double{tool.axis_length}});
    return points;
  }
  for (std::uint32_t p = tool.first_patch; p < tool.first_patch + tool.patch_count; ++p) {
    Vec3 corner[3];
    for (int k = 0; k < 3; ++k) corner[k] = runtime::to_vec(view.tool_vertices[view.tool_patches[p].vertex[k]].point);
    for (int a = 0; a <= 4; ++a) {
      for (int b = 0; a + b <= 4; ++b) points.push_back(0.25 * (a * corner[0] + b * corner[1] + (4 - a - b) * corner[2]));
    }
  }
  return points;
}

TEST(ToolShape, TouchIsTheNearestOfAllCorePoints) {
  for (const bool tree : {false, true}) {
    Options options = with(Options::Tools::all);
    options.search = tree;
    const Opened ball(ball_content(options));
    std::mt19937 random(24);
    std::uniform_real_distribution<double> unit(0, 1);
    ToolTouch last;
    for (std::uint32_t i = 0; i < 600; ++i) {
      const layout::ToolRecord& tool = ball.view.tools[i % 3];
      const Vec3 turn = random_direction(random);
      const Pose pose =
          Pose::from_quaternion(unit(random), turn.x, turn.y, turn.z, 0.1 * unit(random) * random_direction(random));
      double least = 1;
      for (const Vec3& point : core_points(ball.view, tool)) {
        least = std::fmin(least, closest_point(ball.view, pose.apply(point)).signed_distance);
      }
      least -= double{tool.probe_radius};
      last = ToolShape<>(ball.view, i % 3).touch(ball.view, pose, last.body.at);
      ASSERT_LE(last.clearance, least + 1e-12) << i;
      // A capsule's nearest point may lie between the samples.
      if (i % 3 != 1) {
        ASSERT_GE(last.clearance, least - 1e-12) << i;
      }
      ASSERT_NEAR(distance(pose.apply(last.core.point), last.body.point), std::fabs(last.body.signed_distance), 1e-12);
    }
  }
}

TEST(ToolShape, MovesWithinTheSafeDistanceFindNoOverlap) {
  const Opened ball(ball_content(with(Options::Tools::all)));
  std::mt19937 random(25);
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::uint32_t i = 0; i < 900; ++i) {
    const ToolShape<> shape(ball.view, i % 3);
    const Pose from = turned(3 * unit(random), random_direction(random), (0.03 + 0.05 * unit(random)) * random_direction(random));
    const double safe = shape.touch(ball.view, from, {}).safe;
    const Pose by = turned(0.1 * unit(random), random_direction(random), {});
    Pose to = from;
    for (int k = 0; k < 9; ++k) to.rotation[k] = (by * from).rotation[k];
    to.translation = from.translation + 0.01 * unit(random) * random_direction(random);
    if (travel(from, to, shape.extent()) >= safe) continue;
    ASSERT_GE(shape.touch(ball.view, to, {}).clearance, -1e-12) << i;
  }
}

TEST(ToolShape, ExtentHoldsTheWholeSkin) {
  const Opened ball(ball_content(with(Options::Tools::all)));
  for (std::uint32_t tool = 0; tool < 3; ++tool) {
    const ToolShape<> shape(ball.view, tool);
    double farthest = 0;
    for (const Vec3& p : core_points(ball.view, ball.view.tools[tool])) farthest = std::max(farthest, length(p));
    EXPECT_NEAR(shape.reach(), farthest, 1e-9);
    EXPECT_NEAR(shape.extent(), farthest + double{ball.view.tools[tool].probe_radius}, 1e-9);
  }
}

TEST(Capsule, NearestEndTouches) {
  const Opened box(box_content(with(Options::Tools::capsule)));
  const ToolShape<> shape(box.view, 0);
  for (const double angle : {0.0, 0.4, 1.2}) {
    const ToolTouch touch = shape.touch(box.view, leaning(angle, {0, 0, kTop + 0.02}), {});
    EXPECT_NEAR(touch.core.point.z, 0, 1e-9);
    EXPECT_NEAR(touch.clearance, 0.02 - kTipRadius, 1e-8);
    EXPECT_LE(touch.safe, touch.clearance);
  }
  const ToolTouch upside_down = shape.touch(box.view, leaning(2.8, {0, 0, kTop + 0.06}), {});
  EXPECT_NEAR(upside_down.core.point.z, kStemLength, 1e-8);
}

TEST(Capsule, SampledPointFollowsTheTiltOfTheTip) {
  const Opened box(box_content(with(Options::Tools::capsule)));
  const ToolShape<> shape(box.view, 0);
  for (const double degrees : {0.0, 20.0, 45.0, 70.0}) {
    const double angle = degrees * kPi / 180;
    const ToolPoint at = shape.sampled_point({}, leaning(angle, {}), {0, 0, 1});
    EXPECT_EQ(at.patch, degrees <= 45 ? 0U : 1U);
    EXPECT_NEAR(at.weights[1], degrees <= 45 ? degrees / 45 : (degrees - 45) / 45, 1e-6);
  }
  // The far end of the stem is the last vertex, in every tilt.
  const ToolPoint end = shape.sampled_point({{0, 0, kStemLength}, {}}, leaning(kPi / 2, {}), {0, 0, 1});
  EXPECT_EQ(end.patch, 2U);
  EXPECT_NEAR(end.weights[1], 1, 1e-6);
}

TEST(Capsule, PointRunsDownANearlyParallelAxisWithinItsReach) {
  const Opened box(box_content(with(Options::Tools::capsule)));
  const ToolShape<> shape(box.view, 0);
  const Pose leant = leaning(kPi / 2 + 0.02, {-0.01, 0, kTop + kTipRadius});
  CorePoint at;
  at.at = shape.sampled_point(at, leant, {0, 0, 1});
  for (int k = 0; k < 60; ++k) {
    const runtime::Location foot = closest_point(box.view, leant.apply(at.point));
    const CorePoint next = shape.advance(at, leant, foot, {0, 0, 1}, 1e-3);
    EXPECT_LE(distance(next.point, at.point), 1e-3 * (1 + 1e-12));
    EXPECT_LE(leant.apply(next.point).z, leant.apply(at.point).z + 1e-15);
    at = next;
  }
  EXPECT_EQ(at.point.z, double{box.view.tools[0].axis_length}) << "the far end is deeper";
}

TEST(Capsule, PointOnARoundBodyComesToTheNearestPointOfTheAxis) {
  Options options = with(Options::Tools::capsule);
  options.subdivision = 6;
  const Opened ball(ball_content(options));
  const ToolShape<> shape(ball.view, 0);
  for (const double tilt : {-0.4, 0.0, 0.3}) {
    const Pose pose = leaning(kPi / 2 + tilt, {-0.012, 0, kBallRadius + 0.004 + 0.01 * std::fabs(tilt)});
    CorePoint at;
    double reach = 1e-2, last = 0;
    for (int k = 0; k < 30; ++k) {
      last = at.point.z;
      at = shape.advance(at, pose, closest_point(ball.view, pose.apply(at.point)), {0, 0, 1}, reach);
    }
    double best = 0, least = 1;
    for (double z = 0; z <= kStemLength; z += 1e-5) {
      const double d = closest_point(ball.view, pose.apply({0, 0, z})).signed_distance;
      if (d < least) least = d, best = z;
    }
    EXPECT_NEAR(at.point.z, best, 2e-3) << tilt;
    EXPECT_NEAR(at.point.z, last, 1e-3) << tilt << ": it comes to rest";
  }
}

TEST(MeshTool, PointRunsDownToTheLowestCornerWithinItsReach) {
  const Opened box(box_content(with(Options::Tools::mesh)));
  const ToolShape<> shape(box.view, 0);
  std::mt19937 random(26);
  for (int i = 0; i < 100; ++i) {
    const Pose pose = turned(3, random_direction(random), {0, 0, kTop});
    const Vec3 n{0, 0, 1};
    CorePoint at = shape.touch(box.view, turned(3, random_direction(random), {0, 0, kTop + 0.01}), {}).core;
    double least = 1;
    for (const Vec3& p : core_points(box.view, box.view.tools[0])) least = std::min(least, pose.apply(p).z);
    for (int k = 0; k < 400; ++k) {
      const CorePoint next = shape.advance(at, pose, {}, n, 1e-4);
      ASSERT_LE(distance(next.point, at.point), 1e-4 * (1 + 1e-9)) << i;
      ASSERT_LE(pose.apply(next.point).z, pose.apply(at.point).z + 1e-12) << i;
      at = next;
    }
    EXPECT_NEAR(pose.apply(at.point).z, least, 1e-9) << i;
  }
}

}  // namespace
}  // namespace palpate::tool_shape_test
