// SPDX-License-Identifier: GPL-3.0-or-later
// A tool that holds on and is turned: torque of twist and rolling, no work in loops of moves and turns, the reader's
// rules.
#include "palpate/contact/bonded_contact.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "formats/error.hpp"
#include "tests/runtime/allocation_counter.hpp"
#include "tests/runtime/support.hpp"

namespace palpate::turn_test {
namespace {

using namespace test;
using runtime::Contact;
using runtime::Grasp;
using runtime::GraspAnswer;
using runtime::rotation_vector;
using runtime::TurnField;
using runtime::TurningGrasp;
using std::numbers::pi;

constexpr double kDepth = 0.002;
// Of the uniform sample, from coefficient to coefficient a tenth more: there where it is neither deep nor pulled.
constexpr double kGrows = 1.25;

Options turning(bool like = true) {
  Options options = uniform();
  options.uniform = like;
  options.lateral = false;
  options.grasp = options.turn = true;
  return options;
}

Pose about(const Vec3& rotation, const Vec3& at) {
  const double angle = length(rotation);
  const Vec3 axis = angle > 0 ? (std::sin(angle / 2) / angle) * rotation : Vec3{};
  return Pose::from_quaternion(std::cos(angle / 2), axis.x, axis.y, axis.z, at);
}

// Rotation matrices: a b, or a times b transposed.
struct Rotation {
  double entry[9] = {};
};
Rotation times(const double (&a)[9], const double (&b)[9], bool transposed = false) {
  Rotation c;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) c.entry[3 * i + j] += a[3 * i + k] * b[transposed ? 3 * j + k : 3 * k + j];
    }
  }
  return c;
}

// The ball pressed to `depth` on the box's top, turned about the point by which it touches.
Pose at(double depth, const Vec3& rotation = {}, double x = 0, double y = 0) {
  const Vec3 point{x, y, kTop - depth};
  return about(rotation, point - about(rotation, {}).rotate({0, 0, -kTipRadius}));
}

Tick press(Contact& contact, double depth) {
  Tick tick;
  for (int k = -5; k <= 100; ++k) tick = contact.tick(at(depth * k / 100));
  return tick;
}

double draw(std::mt19937& random, double size) {
  return size * (2 * (static_cast<double>(random()) / 4294967296.0) - 1);
}
Vec3 draw_vector(std::mt19937& random, double size) {
  return {draw(random, size), draw(random, size), draw(random, size)};
}

// Angular velocity of a rotation vector that changes at a rate: the left Jacobian of SO(3).
Vec3 angular_velocity(const Vec3& theta, const Vec3& rate) {
  const double a = length(theta);
  if (a < 1e-6) return rate + 0.5 * cross(theta, rate);
  return rate + ((1 - std::cos(a)) / (a * a)) * cross(theta, rate) +
         ((a - std::sin(a)) / (a * a * a)) * cross(theta, cross(theta, rate));
}

TEST(Turn, TakesTheContactOverAndAnswersTwistAndRolling) {
  const Opened box(box_content(turning()));
  Contact contact(box.view, 0);
  const Tick pressed = press(contact, kDepth);
  TurningGrasp grasp(box.view, 0, at(kDepth), pressed);
  ASSERT_TRUE(grasp.holds());
  const Tick rest = grasp.tick(at(kDepth));
  EXPECT_LT(distance(rest.force, pressed.force), 1e-6);
  EXPECT_LT(distance(rest.torque, pressed.torque), 1e-9);
  const auto own_torque = [](const Tick& tick, const Pose& pose) {
    return tick.torque - cross(tick.tool_point - pose.translation, tick.force);
  };
  // There all the sample's curves are in the middle.
  const double level = kDepth - pressed.force.z / kGraspStiffness;
  const Pose flat = at(level), twisted = at(level, {0, 0, 0.1}), rolled = at(level, {0, 0.1, 0});
  EXPECT_LT(length(own_torque(grasp.tick(flat), flat)), 1e-9);
  const Tick twist = grasp.tick(twisted);
  EXPECT_NEAR(own_torque(twist, twisted).z, -0.1 * kGrows * kTwistStiffness, 1e-8);
  EXPECT_LT(std::hypot(twist.force.x, twist.force.y), 1e-9);
  const Tick roll = grasp.tick(rolled);
  EXPECT_NEAR(own_torque(roll, rolled).y, -0.1 * kGrows * kRollStiffness, 1e-8);
  EXPECT_NEAR(roll.force.x, -0.1 * kGrows * kRollForce, 1e-6);
  EXPECT_EQ(roll.state, State::stick);
  EXPECT_FALSE(roll.beyond);
  EXPECT_TRUE(grasp.tick(at(level, {0, 2 * kTurned, 0})).beyond);
}

// A contact that is held sideways goes on with its force, and without a torque about p.
TEST(Turn, KeepsASidewaysForceWithoutATorque) {
  for (const bool like : {true, false}) {
    const Opened box(box_content(turning(like)));
    Contact contact(box.view, 0);
    press(contact, kDepth);
    Tick last;
    for (int k = 1; k <= 100; ++k) last = contact.tick(at(kDepth, {}, 1e-5 * k, -2e-5 * k));
    const Pose here = at(kDepth, {}, 0.001, -0.002);
    TurningGrasp grasp(box.view, 0, here, last);
    ASSERT_TRUE(grasp.holds());
    EXPECT_LT(distance(grasp.tick(here).force, last.force), 1e-6);
    EXPECT_LT(distance(grasp.tick(here).torque, last.torque), 1e-8);
  }
}

// Smooth loops of the rotation vector at rest and under load; the trapezoidal rule of a periodic function is exact to
// round-off.
TEST(Turn, LoopsOfTurnsDoNoWorkToRoundOff) {
  const Opened box(box_content(turning(false)));
  std::mt19937 random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const runtime::Location top = locate(box.view, {draw(random, 0.02), draw(random, 0.02), kTop + 1e-4});
    const TurnField field(box.view, 0, top.at, {});
    ASSERT_GT(field.turned(), 0.0);
    const Vec3 deflection = draw_vector(random, kDepthScale);
    const Vec3 middle = draw_vector(random, 0.25), cosine = draw_vector(random, 0.15), sine = draw_vector(random, 0.15);
    double work = 0, gross = 0;
    constexpr int kSteps = 240;
    for (int k = 0; k < kSteps; ++k) {
      const double s = 2 * pi * k / kSteps;
      const Vec3 theta = middle + std::cos(s) * cosine + std::sin(2 * s) * sine;
      const Vec3 rate = -std::sin(s) * cosine + 2 * std::cos(2 * s) * sine;
      const double power = dot(field.answer(deflection, theta).torque, angular_velocity(theta, rate));
      work += power;
      gross += std::abs(power);
    }
    EXPECT_LT(std::abs(work), 1e-12 * gross);
  }
}

// Moved and turned at once, as the tool goes: deeper and out, beyond what was sampled, and through a half turn.
TEST(Turn, DoesNoWorkInClosedMotions) {
  const Opened box(box_content(turning(false)));
  std::mt19937 random(7);
  for (const double angle : {0.3, 1.5, 2.6}) {
    for (int trial = 0; trial < 8; ++trial) {
      const runtime::Location top = locate(box.view, {draw(random, 0.02), draw(random, 0.02), kTop + 1e-4});
      const TurnField field(box.view, 0, top.at, {});
      Vec3 corner[4], turn[4];
      for (int k = 0; k < 3; ++k)
        corner[k] = draw_vector(random, 2 * kDepthScale), turn[k] = draw_vector(random, angle);
      corner[3] = corner[0], turn[3] = turn[0];
      double work = 0, gross = 0;
      for (int side = 0; side < 3; ++side) {
        // About a fixed axis in space from one rotation to the next.
        constexpr int kSteps = 4000;
        const Pose from = about(turn[side], {});
        const Rotation between = times(about(turn[side + 1], {}).rotation, from.rotation, true);
        const Vec3 step = (1.0 / kSteps) * (corner[side + 1] - corner[side]),
                   way = (1.0 / kSteps) * rotation_vector(between.entry);
        for (int k = 0; k < kSteps; ++k) {
          const Pose part = about((k + 0.5) * way, {});
          const Rotation now = times(part.rotation, from.rotation);
          const GraspAnswer a = field.answer(corner[side] + (k + 0.5) * step, rotation_vector(now.entry));
          const double w = dot(a.force.force, step) + dot(a.torque, way);
          work += w;
          gross += std::abs(w);
        }
      }
      EXPECT_LT(std::abs(work), 1e-6 * gross) << angle;
    }
  }
}

// Right round is where it began, whatever else is held; and nothing jumps on the way.
TEST(Turn, RightRoundIsAClosedAndContinuousMotion) {
  const Opened box(box_content(turning(false)));
  std::mt19937 random(11);
  for (int trial = 0; trial < 10; ++trial) {
    const runtime::Location top = locate(box.view, {draw(random, 0.02), draw(random, 0.02), kTop + 1e-4});
    const TurnField field(box.view, 0, top.at, {});
    const Vec3 deflection = draw_vector(random, kDepthScale), axis = random_direction(random);
    const Pose begin = about(draw_vector(random, 0.5), {});
    constexpr int kSteps = 20000;
    double work = 0, gross = 0, largest = 0, jump = 0, push = 0;
    GraspAnswer before{};
    for (int k = 0; k <= kSteps; ++k) {
      const Pose part = about((2 * pi * (k + 0.5) / kSteps) * axis, {});
      const Rotation now = times(part.rotation, begin.rotation);
      const GraspAnswer a = field.answer(deflection, rotation_vector(now.entry));
      largest = std::max(largest, length(a.torque));
      push = std::max(push, length(a.force.force));
      if (k > 0) {
        jump = std::max(
            {jump, distance(a.torque, before.torque) / largest, distance(a.force.force, before.force.force) / push});
      }
      before = a;
      if (k == kSteps) break;
      work += dot(a.torque, axis);
      gross += std::abs(dot(a.torque, axis));
    }
    EXPECT_LT(std::abs(work), 1e-6 * gross);
    EXPECT_LT(jump, 5e-3);
  }
}

// The torque grows no more beyond 1 rad, and never helps a turn on that began at rest.
TEST(Turn, ATwistIsOpposedUpToAHalfTurn) {
  const Opened box(box_content(turning()));
  const TurnField field(box.view, 0, locate(box.view, {0, 0, kTop + 1e-4}).at, {});
  double last = 0;
  for (int k = 1; k < 300; ++k) {
    const double angle = pi * k / 300, torque = field.answer({}, {0, 0, angle}).torque.z;
    EXPECT_LT(torque, 0);
    if (angle < layout::kLargestTurn) {
      EXPECT_LT(torque, last);
    }
    EXPECT_GT(torque, -1.2 * kGrows * kTwistStiffness);
    last = torque;
  }
}

TEST(Turn, IsContinuousOverEdges) {
  Options options = turning(false);
  options.subdivision = 2;
  const Opened ball(ball_content(options));
  std::mt19937 random(43);
  for (int trial = 0; trial < 500; ++trial) {
    runtime::BodyPoint here{static_cast<std::uint32_t>(random() % ball.view.meta->triangle_count), {0, 0, 0}};
    const int corner = static_cast<int>(random() % 3);
    const double share = static_cast<double>(random()) / 4294967296.0;
    here.bary[(corner + 1) % 3] = share;
    here.bary[(corner + 2) % 3] = 1 - share;
    const TurnField one(ball.view, 0, here, {}), other(ball.view, 0, runtime::cross_edge(ball.view, here, corner), {});
    const Vec3 deflection = 2e-3 * random_direction(random), rotation = 0.2 * random_direction(random);
    const GraspAnswer a = one.answer(deflection, rotation), b = other.answer(deflection, rotation);
    ASSERT_LT(distance(a.force.force, b.force.force), 1e-9 * length(a.force.force));
    ASSERT_LT(distance(a.torque, b.torque), 1e-9 * length(a.torque));
  }
}

// Without turns in the file, or of a tool that has none, it is a grasp.
TEST(Turn, WithoutTurnsItIsAGrasp) {
  Options grasps = turning();
  grasps.turn = false;
  const Opened box(box_content(grasps));
  Contact contact(box.view, 0);
  const Tick pressed = press(contact, kDepth);
  TurningGrasp turning_grasp(box.view, 0, at(kDepth), pressed);
  Grasp grasp(box.view, 0, at(kDepth), pressed);
  ASSERT_TRUE(turning_grasp.holds() && grasp.holds());
  const Pose there = at(-0.001, {0.1, 0.2, 0.3}, 0.001, 0.002);
  const Tick a = turning_grasp.tick(there), b = grasp.tick(there);
  EXPECT_EQ(distance(a.force, b.force), 0);
  EXPECT_EQ(distance(a.torque, b.torque), 0);
  Options two = turning();
  two.tools = Options::Tools::all;
  const Opened all(box_content(two));
  const runtime::Location top = locate(all.view, {0.003, 0.004, kTop + 1e-4});
  EXPECT_GT(TurnField(all.view, 0, top.at, {}).turned(), 0.0);
  EXPECT_EQ(TurnField(all.view, 1, top.at, {all.view.tools[1].first_patch, {1, 0, 0}}).turned(), 0.0);
}

TEST(Turn, TicksAllocateNothingAndEndAtAPoseThatIsNone) {
  const Opened box(box_content(turning(false)));
  Contact contact(box.view, 0);
  const Tick pressed = press(contact, kDepth);
  const long before = allocations();
  TurningGrasp grasp(box.view, 0, at(kDepth), pressed);
  bool finite = grasp.holds();
  for (int k = 0; k <= 1000; ++k) {
    const double s = k / 1000.0;
    const Tick tick = grasp.tick(at(kDepth - 0.02 * s, {7 * s, -2 * s, 3 * s}, 0.05 * s, 0));
    finite = finite && std::isfinite(length(tick.force)) && std::isfinite(length(tick.torque));
  }
  EXPECT_EQ(allocations() - before, 0);
  EXPECT_TRUE(finite);
  Pose broken = at(kDepth);
  broken.rotation[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(grasp.tick(broken).state, State::fault);
  EXPECT_FALSE(grasp.holds());
}

TEST(Turn, RotationVectorIsTheLogarithm) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const double sizes[] = {1e-9, 1e-3, 1.0, 3.0, pi - 1e-7};
    const Vec3 theta = sizes[trial % 5] * random_direction(random);
    EXPECT_LT(distance(rotation_vector(about(theta, {}).rotation), theta), 1e-8 * length(theta) + 1e-15);
  }
  EXPECT_EQ(length(rotation_vector(Pose{}.rotation)), 0);
  EXPECT_NEAR(length(rotation_vector({-1, 0, 0, 0, -1, 0, 0, 0, 1})), pi, 1e-15);
}

// What would make energy without bound or end continuity is refused by the reader.
TEST(Turn, IsRefusedWhereItsCurvesBreakTheRules) {
  const auto refused = [](const std::function<void(Response&)>& spoil) {
    ResponseFileContent content = box_content(turning());
    spoil(content.responses[3]);
    try {
      encode(content);
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("TURN: response 3"), std::string::npos) << error.what();
      return true;
    }
    return false;
  };
  constexpr int n = 6;
  EXPECT_FALSE(refused([](Response&) {}));
  EXPECT_FALSE(refused([](Response& r) { r.turn[2] = 1; }));
  for (const int curve : {3, 8, 9, 14}) {
    EXPECT_TRUE(refused([=](Response& r) { r.turn[curve * n] += 1e-3F; })) << curve;
    EXPECT_TRUE(refused([=](Response& r) { r.turn[curve * n + n - 1] += 1e-3F; })) << curve;
  }
  EXPECT_TRUE(refused([](Response& r) { r.turn[5 * n + 2] = 0; }));
  EXPECT_TRUE(refused([](Response& r) { r.turn[8 * n + 2] = -1e-3F; }));
  EXPECT_TRUE(refused([](Response& r) { r.turn[6 * n + 2] = 1; }));
  // Beyond the geometric mean of the two stiffnesses a roll and a move together would give energy.
  EXPECT_TRUE(
      refused([](Response& r) { r.turn[10 * n + 3] = 1.01F * std::sqrt(r.grasp[3 * n + 3] * r.turn[5 * n + 3]); }));
  EXPECT_FALSE(
      refused([](Response& r) { r.turn[10 * n + 3] = 0.99F * std::sqrt(r.grasp[3 * n + 3] * r.turn[5 * n + 3]); }));
  EXPECT_TRUE(refused([](Response& r) { r.turn[0] = std::numeric_limits<float>::infinity(); }));
  EXPECT_TRUE(refused([](Response& r) { r.turn[12 * n + 1] = std::numeric_limits<float>::quiet_NaN(); }));
  EXPECT_TRUE(refused([](Response& r) { r.turned = 1.1; }));
  EXPECT_TRUE(refused([](Response& r) { r.turned = 0; }));
}

}  // namespace
}  // namespace palpate::turn_test
