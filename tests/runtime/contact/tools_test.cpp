// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts of capsules and mesh tools: the point that touches follows the pose continuously.
#include <algorithm>
#include <cmath>

#include "tests/runtime/support.hpp"

namespace palpate::tools_test {
namespace {

using namespace test;
using runtime::Contact;

// The tool's z axis leans by `angle` from vertical towards +x.
Pose leaning(double angle, const Vec3& at) {
  return Pose::from_quaternion(std::cos(angle / 2), 0, std::sin(angle / 2), 0, at);
}

Options with(Options::Tools tools) {
  Options options;
  options.tools = tools;
  return options;
}

TEST(Capsule, SampledPointFollowsTheTilt) {
  const Opened box(box_content(with(Options::Tools::capsule)));
  for (const double degrees : {0.0, 20.0, 45.0, 70.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    Contact contact(box.view, 0);
    Tick tick;
    for (int i = 0; i <= 300; ++i) tick = contact.tick(leaning(angle, {0, 0, kTop + kTipRadius + 0.001 - 1e-5 * i}));
    ASSERT_GT(length(tick.force), 0.1) << degrees;
    EXPECT_EQ(tick.on_tool.at.patch, degrees <= 45 ? 0U : 1U);
    EXPECT_NEAR(tick.on_tool.at.weights[1], degrees <= 45 ? degrees / 45 : (degrees - 45) / 45, 1e-6);
  }
}

TEST(Capsule, StemThatIsLaidDownMovesTheContactContinuously) {
  const Opened box(box_content(with(Options::Tools::capsule)));
  Contact contact(box.view, 0);
  const auto pose = [](double angle) { return leaning(angle, {-0.01, 0, kTop + kTipRadius - 0.001}); };
  for (int i = 0; i <= 200; ++i) contact.tick(leaning(0.8, {-0.01, 0, kTop + kTipRadius + 0.001 - 1e-5 * i}));
  Tick last = contact.tick(pose(0.8));
  ASSERT_GT(length(last.force), 0.05);
  for (int i = 0; i <= 8000; ++i) {
    const Tick tick = contact.tick(pose(0.8 + 0.85 * i / 8000));  // to 1.65 rad: the far end is lower
    ASSERT_LT(distance(tick.force, last.force), 0.05) << i;
    last = tick;
  }
  for (int i = 0; i < 2000; ++i) last = contact.tick(pose(1.65));
  EXPECT_GT(last.body_point.x, 0.01);  // c has gone along the stem
  EXPECT_GT(last.force.z, 0);
}

/// A stem that lies on the box, its far end a little deeper, is tilted up about its tip and laid down again, and drawn
/// aside meanwhile: p runs to the tip while the tool is tilted, and back.
struct Tilting {
  double tilt, seconds;  ///< rad; s
  [[nodiscard]] Pose at(double t) const {
    const double phase = 2 * std::numbers::pi * t / seconds, angle = 0.5 * (1 - std::cos(phase)) * tilt - 0.02;
    const double aside = 0.002 * std::sin(phase);
    return leaning(std::numbers::pi / 2 - angle, {aside - 0.014, aside, kTop + kTipRadius - 0.0025});
  }
};

double meridian_of(const runtime::View& view, const runtime::ToolPoint& at) {
  const auto& corner = view.tool_patches[at.patch].vertex;
  return at.weights[0] * view.tool_vertices[corner[0]].meridian +
         at.weights[1] * view.tool_vertices[corner[1]].meridian;
}

struct Tilted {
  std::vector<Vec3> forces;        ///< N, every millisecond
  double step = 0, per_metre = 0;  ///< N in a tick, and over the way of the skin there (N/m)
  double ran = 0;                  ///< that p went on the profile over the way of the skin that went farthest
  double least = 1, most = 0;      ///< m, of its meridian
  int lost = 0, unsettled = 0;     ///< ticks without contact; at rest, ticks in which the force changed
};

/// With so many ticks in a millisecond.
Tilted tilt(const runtime::View& view, const Tilting& motion, int fine) {
  Contact contact(view, 0);
  Pose before = motion.at(0);
  Tick last;
  for (int i = 0; i <= 500; ++i) {
    before.translation.z = motion.at(0).translation.z + 1e-5 * (500 - i);
    last = contact.tick(before);
  }
  Tilted r;
  const int ticks = static_cast<int>(std::lround(1000 * motion.seconds)) * fine;
  for (int i = 1; i <= ticks; ++i) {
    const Pose pose = motion.at(1e-3 * i / fine);
    const Tick tick = contact.tick(pose);
    r.lost += tick.state != State::stick && tick.state != State::slide;
    const double turn = distance(pose.rotate({0, 0, 1}), before.rotate({0, 0, 1}));
    const Vec3 taken = pose.apply(inverse(before).apply(last.tool_point));
    const double skin = distance(taken, last.tool_point) + kTipRadius * turn, step = distance(tick.force, last.force);
    const double meridian = meridian_of(view, tick.on_tool.at);
    r.step = std::max(r.step, step);
    r.per_metre = std::max(r.per_metre, step / skin);
    r.ran = std::max(r.ran, std::fabs(meridian - meridian_of(view, last.on_tool.at)) / (skin + kStemLength * turn));
    r.least = std::min(r.least, meridian);
    r.most = std::max(r.most, meridian);
    if (i % fine == 0) r.forces.push_back(tick.force);
    for (int k = 0; i % (50 * fine) == 0 && k < 20; ++k) {
      r.unsettled += distance(contact.tick(pose).force, tick.force) > 0;
    }
    last = tick;
    before = pose;
  }
  return r;
}

// When p reaches the end of the axis of a tilted tool, the surface parallel to the body is elsewhere on the tip. p then
// moves there as the tool moves, at any length of the ticks.
TEST(Capsule, TiltedStemComesToItsTipWithoutAStep) {
  Options options = with(Options::Tools::capsule);
  options.friction = options.bias = false;
  options.uniform = true;
  ResponseFileContent content = box_content(options);
  const std::size_t vertices = content.tool_vertex_count();
  ASSERT_EQ(vertices, 4U);
  for (std::size_t i = 0; i < content.responses.size(); ++i) {
    constexpr double kFactors[] = {1.0, 0.7, 1.3, 1.0};  // pole, tip at 45 degrees, where the stem begins and ends
    content.responses[i].unit *= static_cast<float>(kFactors[i % vertices]);
  }
  const Opened box(std::move(content));
  for (const Tilting& motion : {Tilting{0.3, 1}, Tilting{0.6, 1}, Tilting{1.2, 1}, Tilting{1.2, 3}}) {
    SCOPED_TRACE(motion.tilt);
    const Tilted coarse = tilt(box.view, motion, 1), fine = tilt(box.view, motion, 10);
    double force = 0, apart = 0;
    for (std::size_t i = 0; i < fine.forces.size(); ++i) {
      force = std::max(force, length(fine.forces[i]));
      apart = std::max(apart, distance(coarse.forces[i], fine.forces[i]));
    }
    EXPECT_LT(fine.least, kTipRadius * (std::numbers::pi / 2 - motion.tilt + 0.03)) << "it came where it is tilted to";
    EXPECT_GT(fine.most, kStemLength) << "from the far end";
    for (const Tilted& t : {coarse, fine}) {
      EXPECT_LT(t.per_metre, 2.5 * 1.3 * 1.6 * kHertzForce / kDepthScale);
      EXPECT_LT(t.ran, 12) << "eight times the travel of the whole tool";
      EXPECT_EQ(t.unsettled + t.lost, 0);
    }
    EXPECT_LT(apart, 0.06 * force);
  }
}

TEST(MeshTool, LowestCornerPresses) {
  const Opened box(box_content(with(Options::Tools::mesh)));
  Contact contact(box.view, 0);
  Tick tick;
  Pose pose;
  for (int i = 0; i <= 300; ++i) {
    pose = upright({0.001, 0.002, kTop + 0.004 + 0.001 - 1e-5 * i});
    tick = contact.tick(pose);
  }
  EXPECT_NEAR(tick.depth, 0.002, 1e-7);
  EXPECT_GT(tick.force.z, 0.1);
  EXPECT_LT(distance(tick.tool_point, {0.001, 0.002, kTop - 0.002}), 1e-7);
  // The corner at (0, 0, -1) is vertex 5 of the tool.
  const auto& patch = box.view.tool_patches[tick.on_tool.at.patch].vertex;
  double weight = 0;
  for (int k = 0; k < 3; ++k) weight += patch[k] == 5 ? tick.on_tool.at.weights[k] : 0;
  EXPECT_EQ(weight, 1);
}

/// A gem that stands on a corner, 2 mm deep, is turned about its middle until it stands on the next, and back.
struct Rolled {
  double depth = 0, force = 0;  ///< m and N, on the next corner
  std::uint32_t corner = 0;     ///< vertex of the tool that is p there; 99 where none is
  double step = 0, ran = 0;     ///< N in a tick; most that p went over the tool over the way of its skin
  double least = 0, work = 0;   ///< J, of the hand: least since the first touch, and at the end, out of the body
  int lost = 0, unsettled = 0;  ///< ticks without contact; at rest, ticks in which the force changed
};

Rolled roll(const runtime::View& view, int ticks) {
  constexpr double kSize = 0.004, kQuarter = std::numbers::pi / 2;
  const auto pose = [&](double angle, double lift) {
    return turned(angle, {0, 1, 0}, {3e-4, 2e-4, kTop + 0.5 * kSize + lift});
  };
  Contact contact(view, 0);
  Pose before = pose(0, 0.003);
  Tick last = contact.tick(before);
  Rolled r;
  const auto go_to = [&](const Pose& to) {
    const Tick tick = contact.tick(to);
    const Vec3 way = to.translation - before.translation;
    const Vec3 turn = 0.5 * (cross(before.rotate({1, 0, 0}), to.rotate({1, 0, 0})) +
                             cross(before.rotate({0, 0, 1}), to.rotate({0, 0, 1})));
    r.work -= 0.5 * (dot(last.force + tick.force, way) + dot(last.torque + tick.torque, turn));
    r.least = std::min(r.least, r.work);
    if (tick.touches() && last.touches()) {
      const Vec3 here = inverse(to).apply(tick.tool_point), there = inverse(before).apply(last.tool_point);
      const double skin = distance(to.apply(there), before.apply(there)) + kSize * length(turn);
      if (skin > 0) r.ran = std::max(r.ran, distance(here, there) / skin);
    }
    r.step = std::max(r.step, distance(tick.force, last.force));
    before = to;
    last = tick;
    return tick;
  };
  for (int i = 1; i <= ticks; ++i) go_to(pose(0, 0.003 * (ticks - i) / ticks));
  for (const bool back : {false, true}) {
    for (int i = 0; i <= ticks; ++i) {
      const Pose there = pose(kQuarter * (back ? ticks - i : i) / ticks, 0);
      const Tick tick = go_to(there);
      r.lost += tick.touches() ? 0 : 1;
      if (i % (ticks / 40) != 0) continue;
      for (int k = 0; k < 10; ++k) r.unsettled += distance(contact.tick(there).force, tick.force) > 0;
    }
    if (back) continue;
    r.depth = last.depth;
    r.force = last.force.z;
    r.corner = 99;
    for (int k = 0; k < 3; ++k) {
      if (last.on_tool.at.weights[k] == 1) r.corner = view.tool_patches[last.on_tool.at.patch].vertex[k];
    }
  }
  for (int i = 1; i <= ticks; ++i) go_to(pose(0, 0.003 * i / ticks));
  EXPECT_FALSE(last.touches());
  return r;
}

// The corner that was pressed first lifts off when the next is 1.5 mm deep: what that pushes is not lost, for p has run
// there by then. On the way the edge is deeper by what p takes to run along it; that alone is held back.
TEST(MeshTool, RollsFromCornerToCorner) {
  for (const bool friction : {false, true}) {
    Options options = uniform();
    options.tools = Options::Tools::mesh;
    options.friction = options.bias = friction;
    const Opened box(box_content(options));
    const Rolled coarse = roll(box.view, 2000), fine = roll(box.view, 20000);
    for (const Rolled& r : {coarse, fine}) {
      EXPECT_EQ(r.lost, 0);
      EXPECT_EQ(r.unsettled, 0);
      EXPECT_EQ(r.corner, 0U);
      EXPECT_NEAR(r.depth, 0.002, 0.00015);
      EXPECT_NEAR(r.force, hertz(0.002), 0.1 * hertz(0.002));
      EXPECT_LT(r.ran, 24.1);
      EXPECT_GT(r.least, -1e-9);
      EXPECT_GT(r.work, 0);
    }
    EXPECT_LT(fine.step, 0.3 * coarse.step) << "ten times as many ticks";
  }
}

TEST(MeshTool, TouchesFromEverySide) {
  const Opened ball(ball_content(with(Options::Tools::mesh)));
  std::mt19937 random(21);
  for (int i = 0; i < 30; ++i) {
    Contact contact(ball.view, 0);
    const Vec3 direction = random_direction(random);
    const Vec3 turn = random_direction(random);
    Tick tick;
    for (int k = 0; k <= 600; ++k) {
      const double r = kBallRadius + 0.005 - 1e-5 * k;
      tick = contact.tick(Pose::from_quaternion(0.6, turn.x, turn.y, turn.z, r * direction));
    }
    EXPECT_GT(dot(tick.force, direction), 0.01);
  }
}

TEST(SafeDistance, FreeToolIsFreeForASearchToo) {
  const Opened ball(ball_content(with(Options::Tools::all)));
  std::mt19937 random(22);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (std::uint32_t tool = 0; tool < 3; ++tool) {
    for (int path = 0; path < 4; ++path) {
      Contact follower(ball.view, tool);
      const Vec3 direction = random_direction(random), turn = random_direction(random);
      for (int k = 0; k <= 1500; ++k) {
        const double r = 0.12 - 0.1 * k / 1500;
        const Pose pose = Pose::from_quaternion(1, turn.x * k * 1e-3, turn.y * k * 1e-3, 0, r * direction);
        const Tick tick = follower.tick(pose);
        if (tick.touches()) break;
        // Free for the follower, which skips searches: so it must be for one that has just begun.
        ASSERT_GE(runtime::ToolShape<>(ball.view, tool).touch(ball.view, pose, {}).clearance, -2e-3) << tool << " " << k;
      }
    }
  }
}

// Past the body, into it, through it and out again.
void expect_free_for_a_search(std::uint32_t tool) {
  const Opened ball(ball_content(with(Options::Tools::all)));
  std::mt19937 random(23);
  std::uniform_real_distribution<double> unit(0, 1);
  {
    Contact contact(ball.view, tool);
    Vec3 at{0, 0, 1.4 * kBallRadius};
    int touching = 0, deep = 0;
    for (int k = 0; k < 4000; ++k) {
      const Vec3 to = at + (0.08 * std::pow(10, -4 * unit(random))) * random_direction(random);
      if (length(to) < 1.5 * kBallRadius) at = to;
      const Pose pose = Pose::from_quaternion(1, 0.2 * std::sin(1e-3 * k), 0.2 * std::cos(2e-3 * k), 0, at);
      const State state = contact.tick(pose).state;
      touching += state == State::stick || state == State::slide ? 1 : 0;
      deep += length(at) < 0.5 * kBallRadius ? 1 : 0;
      if (state == State::free) {
        ASSERT_GE(runtime::ToolShape<>(ball.view, tool).touch(ball.view, pose, {}).clearance, -2e-3) << tool << " " << k;
      }
    }
    EXPECT_GT(touching, 200);
    EXPECT_GT(deep, 15);
  }
}

TEST(SafeDistance, FreeToolThatLeapsIsFreeForASearchToo) {
  expect_free_for_a_search(0);
  expect_free_for_a_search(2);
}

// A capsule's contact ends where its point leaves the body though another part of the stem overlaps.
TEST(SafeDistance, FreeCapsuleThatLeapsIsFreeForASearchToo) { expect_free_for_a_search(1); }

}  // namespace
}  // namespace palpate::tools_test
