// SPDX-License-Identifier: GPL-3.0-or-later
// Bonded contacts: takeover without a step, pulls, twist and rolling, no work in closed motions, moving bodies.
#include "palpate/contact/bonded_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "palpate/body/rigid_motion.hpp"
#include "palpate/body/stiffness_scale.hpp"
#include "tests/runtime/allocation_counter.hpp"
#include "tests/runtime/support.hpp"

namespace palpate::bonded_test {
namespace {

using namespace test;
using runtime::BodyPoint;
using runtime::BondedContact;
using runtime::BondedContact6D;
using runtime::BondedForce;
using runtime::Contact;
using runtime::RigidMotion;
using runtime::rotation_pose;
using runtime::rotation_vector;
using std::numbers::pi;
using Response3D = runtime::BondedResponse<false>;
using Response6D = runtime::BondedResponse<true>;

constexpr double kDepth = 0.002;
// Stiffness of the uniform sample at z = 0 over that of the first coefficient.
constexpr double kMiddle = 1.25;

Options bonded(bool like = true) {
  Options options = uniform();
  options.uniform = like;
  options.bias = false;
  options.bonded = options.bonded_torque = true;
  return options;
}

// The ball at `depth` in the box's top, rotated about the point of its skin that touches.
Pose at(double depth, const Vec3& rotation = {}, double x = 0, double y = 0) {
  Pose pose = rotation_pose(rotation);
  pose.translation = Vec3{x, y, kTop - depth} - pose.rotate({0, 0, -kTipRadius});
  return pose;
}
Pose beside(double depth, double x, double y) { return at(depth, {}, x, y); }

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
BodyPoint on_top(const runtime::View& view, std::mt19937& random) {
  return runtime::closest_point(view, {draw(random, 0.02), draw(random, 0.02), kTop + 1e-4}).at;
}

// The same point of an edge, in the triangle on the other side.
BodyPoint across_edge(const runtime::View& view, const BodyPoint& here, int corner) {
  const auto& from = view.triangle(here.triangle);
  BodyPoint there{from.neighbour[corner], {0, 0, 0}};
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      if (view.triangle(there.triangle).vertex[j] == from.vertex[k] && k != corner) there.bary[j] = here.bary[k];
    }
  }
  return there;
}

// Angular velocity of a rotation vector that changes at a rate: the left Jacobian of SO(3).
Vec3 angular_velocity(const Vec3& theta, const Vec3& rate) {
  const double a = length(theta);
  if (a < 1e-6) return rate + 0.5 * cross(theta, rate);
  return rate + ((1 - std::cos(a)) / (a * a)) * cross(theta, rate) +
         ((a - std::sin(a)) / (a * a * a)) * cross(theta, cross(theta, rate));
}

TEST(BondedContact, TakesOverTheForceAndResistsPulls) {
  const Opened box(box_content(bonded()));
  Contact contact(box.view, 0);
  const Tick pressed = press(contact, kDepth);
  ASSERT_EQ(pressed.state, State::stick);
  BondedContact bond(box.view, 0, at(kDepth), pressed);
  ASSERT_TRUE(bond.holds());
  EXPECT_LT(distance(bond.tick(at(kDepth)).force, pressed.force), 1e-6);
  for (const double depth : {0.001, 0.0, -0.001, -0.002}) {
    const Tick tick = bond.tick(at(depth));
    EXPECT_EQ(tick.state, State::stick);
    EXPECT_NEAR(tick.force.z, pressed.force.z + kBondedStiffness * (depth - kDepth), 1e-5);
    EXPECT_LT(std::hypot(tick.force.x, tick.force.y), 1e-6);
    EXPECT_LT(distance(tick.body_point, pressed.body_point), 1e-12);
    EXPECT_FALSE(tick.extrapolated);
  }
  EXPECT_TRUE(bond.tick(at(-2 * kDepthScale)).extrapolated);
  const Pose aside = beside(-0.001, 0.003, 0.001);
  const Tick tick = bond.tick(aside);
  EXPECT_LT(tick.force.x, -0.003 * kBondedTangential);
  EXPECT_NEAR(tick.force.x / tick.force.y, 3.0, 1e-5);
  EXPECT_LT(distance(tick.torque, cross(tick.tool_point - aside.translation, tick.force)), 1e-12);
  EXPECT_TRUE(std::isinf(tick.friction_limit));
}

TEST(BondedContact, TangentialForceContinuesAtTheBond) {
  for (const bool like : {true, false}) {
    const Opened box(box_content(bonded(like)));
    Contact contact(box.view, 0);
    press(contact, kDepth);
    Tick last;
    for (int k = 1; k <= 100; ++k) last = contact.tick(beside(kDepth, 1e-5 * k, -2e-5 * k));
    ASSERT_GT(std::hypot(last.force.x, last.force.y), 1e-3);
    const Pose here = beside(kDepth, 0.001, -0.002);
    BondedContact bond(box.view, 0, here, last);
    BondedContact6D bond_6d(box.view, 0, here, last);
    ASSERT_TRUE(bond.holds() && bond_6d.holds());
    EXPECT_LT(distance(bond.tick(here).force, last.force), 1e-6);
    EXPECT_LT(distance(bond_6d.tick(here).force, last.force), 1e-6);
    EXPECT_LT(distance(bond_6d.tick(here).torque, last.torque), 1e-8);
  }
}

TEST(BondedContact, MovingBodyGivesTheForceOfABodyAtRest) {
  const Opened box(box_content(bonded()));
  const auto body = [&](double t) {
    return RigidMotion{
        &box.view, turned(1.2 + 0.3 * std::sin(3 * t), unit(Vec3{1, 2, -1}, {}), {0.1, 0.2 * std::sin(2 * t), 0.3})};
  };
  Contact rest(box.view, 0), moving(box.view, 0);
  Tick still, tick;
  Pose held;
  for (int k = -5; k <= 100; ++k) {
    held = beside(kDepth * k / 100, 1e-5 * std::max(k, 0), 0);
    still = rest.tick(held);
    tick = moving.tick(body(0.01 * k).pose * held, body(0.01 * k));
  }
  BondedContact6D alone(box.view, 0, held, still), bond(box.view, 0, body(1).pose * held, tick, body(1));
  ASSERT_TRUE(alone.holds() && bond.holds());
  EXPECT_LT(distance(alone.tick(held).force, still.force), 1e-6);
  for (int k = 0; k < 100; ++k) {
    const RigidMotion now = body(1 + 0.01 * k);
    const Pose pulled = at(kDepth - 4e-5 * k, {1e-3 * k, 0, 2e-3 * k}, 1e-3 - 2e-5 * k);
    const Tick expected = runtime::transformed(now.pose, alone.tick(pulled)), given = bond.tick(now.pose * pulled, now);
    ASSERT_EQ(given.state, State::stick);
    ASSERT_LT(distance(given.force, expected.force), 1e-6) << k;
    ASSERT_LT(distance(given.torque, expected.torque), 1e-8) << k;
    ASSERT_LT(distance(given.body_point, expected.body_point), 1e-9) << k;
  }
}

struct ScaledBox {
  Opened box{box_content(bonded())};
  std::vector<runtime::SiteScales::Scale> memory = std::vector<runtime::SiteScales::Scale>(box.view.meta->site_count);
  runtime::SiteScales scales{box.view, memory.data()};
  runtime::StiffnessScale<runtime::StillBody> body{{&box.view}, &scales, &box.view};
  void set_all(float factor) {
    for (std::uint32_t i = 0; i < box.view.meta->site_count; ++i) ASSERT_TRUE(scales.set(i, factor));
  }
};

// A bond at a pressed contact of such a box.
template <class Bond>
struct ScaledBond {
  explicit ScaledBond(double step) {
    a.body.step = step;
    EXPECT_TRUE(bond.holds());
  }
  ScaledBox a;
  Contact contact{a.box.view, 0};
  Tick pressed = press(contact, kDepth);
  Bond bond{a.box.view, 0, at(kDepth), pressed, a.body};
  Tick tick(const Pose& tool) { return bond.tick(tool, a.body); }
};

TEST(BondedContact, StiffnessFactorScalesTheForceAtABoundedRate) {
  ScaledBond<BondedContact> held(0.01);
  held.a.set_all(0.5F);
  EXPECT_LT(distance(held.tick(at(kDepth)).force, 0.99 * held.pressed.force), 1e-6);
  Tick tick;
  for (int k = 0; k < 60; ++k) tick = held.tick(at(kDepth));
  EXPECT_LT(distance(tick.force, 0.5 * held.pressed.force), 1e-6);
}

TEST(BondedContact, FactorThatRisesLeavesTheForceAndScalesTheStiffness) {
  for (const double step : {0.01, 100.0}) {
    ScaledBond<BondedContact> held(step);
    held.a.set_all(4);
    Vec3 force;
    for (int k = 0; k < 400; ++k) {
      force = held.tick(at(kDepth)).force;
      ASSERT_LT(distance(force, held.pressed.force), 0.02 * length(held.pressed.force)) << k;
    }
    const double slope = (held.tick(at(kDepth + 1e-5)).force.z - force.z) / 1e-5;
    EXPECT_NEAR(slope, 4 * kBondedStiffness, 0.02 * 4 * kBondedStiffness);
    // A force that was lost at rest does not come back.
    held.a.set_all(0);
    for (int k = 0; k < 500; ++k) force = held.tick(at(kDepth)).force;
    EXPECT_EQ(length(force), 0);
    held.a.set_all(1);
    for (int k = 0; k < 500; ++k) ASSERT_LT(length(held.tick(at(kDepth)).force), 1e-12);
  }
}

// Random motions with random factors: the hand gets back at most its work and what the contact stored at the bond.
template <class Bond>
double energy_given(double step, unsigned seed) {
  ScaledBond<Bond> held(step);
  const double stored = dot(held.pressed.force, held.pressed.force) / (2 * kBondedStiffness);
  std::mt19937 random(seed);
  runtime::EnergyMeter meter;
  double most = 0;
  Vec3 goal{0, 0, kDepth}, now = goal, turn, turn_goal;
  for (int k = 0; k < 20000; ++k) {
    if (k % 100 == 0) {
      const bool rests = random() % 2 == 0;
      if (!rests) goal = draw_vector(random, 0.003), turn_goal = draw_vector(random, 0.4);
      held.a.set_all(static_cast<float>(2 + draw(random, 2)));
    }
    now = now + 0.05 * (goal - now);
    turn = turn + 0.05 * (turn_goal - turn);
    const Pose pose = at(now.z, turn, now.x, now.y);
    meter.add(pose, held.tick(pose));
    most = std::max(most, (meter.returned() - meter.given() - stored) / stored);
  }
  return most;
}

TEST(BondedContact, ChangingFactorsGiveNoEnergy) {
  for (const double step : {0.01, 0.2, 100.0}) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
      EXPECT_LT(energy_given<BondedContact>(step, seed), 1e-3) << step << ' ' << seed;
      EXPECT_LT(energy_given<BondedContact6D>(step, seed), 1e-3) << step << ' ' << seed;
    }
  }
}

TEST(BondedContact, NoBondWithoutResponsesContactOrBearableForce) {
  const Opened without(box_content(uniform()));
  Contact contact(without.view, 0);
  EXPECT_FALSE(BondedContact(without.view, 0, at(kDepth), press(contact, kDepth)).holds());
  const Opened box(box_content(bonded()));
  EXPECT_FALSE(BondedContact(box.view, 0, at(kDepth), Tick{}).holds());
  Contact other(box.view, 0);
  const Tick good = press(other, kDepth);
  EXPECT_FALSE(BondedContact(box.view, 7, at(kDepth), good).holds());
  Tick heavy = good;
  heavy.force = {0, 0, 2 * kBondedStiffness * layout::kBondedRange * kDepthScale};
  EXPECT_FALSE(BondedContact(box.view, 0, at(kDepth), heavy).holds());
}

TEST(BondedContact, InvalidPoseIsAFaultAndEndsTheBond) {
  const Opened box(box_content(bonded()));
  Contact contact(box.view, 0);
  BondedContact bond(box.view, 0, at(kDepth), press(contact, kDepth));
  ASSERT_TRUE(bond.holds());
  Pose broken = at(kDepth);
  broken.rotation[4] = std::numeric_limits<double>::quiet_NaN();
  const Tick tick = bond.tick(broken);
  EXPECT_EQ(tick.state, State::fault);
  EXPECT_EQ(tick.fault, runtime::Fault::bad_pose);
  EXPECT_FALSE(bond.holds());
  EXPECT_EQ(bond.tick(at(kDepth)).state, State::free);
}

TEST(BondedContact, OnlyTheToolWithResponsesBonds) {
  Options options = bonded();
  options.tools = Options::Tools::all;
  const Opened box(box_content(options));
  const BodyPoint top = runtime::closest_point(box.view, {0.003, 0.004, kTop + 1e-4}).at;
  const runtime::ToolPoint other{box.view.tools[1].first_patch, {1, 0, 0}};
  EXPECT_GT(Response6D(box.view, 0, top, {}).depth(), 0.0);
  EXPECT_GT(Response6D(box.view, 0, top, {}).rotated(), 0.0);
  EXPECT_EQ(Response6D(box.view, 1, top, other).depth(), 0.0);
  EXPECT_EQ(Response6D(box.view, 1, top, other).rotated(), 0.0);
}

TEST(BondedResponse, ForceIsContinuousAcrossEdges) {
  Options options = bonded(false);
  options.subdivision = 2;
  const Opened ball(ball_content(options));
  std::mt19937 random(43);
  for (int trial = 0; trial < 1000; ++trial) {
    BodyPoint here{static_cast<std::uint32_t>(random() % ball.view.meta->triangle_count), {0, 0, 0}};
    const int corner = static_cast<int>(random() % 3);
    const double share = static_cast<double>(random()) / 4294967296.0;
    here.bary[(corner + 1) % 3] = share;
    here.bary[(corner + 2) % 3] = 1 - share;
    const Response6D one(ball.view, 0, here, {}), other(ball.view, 0, across_edge(ball.view, here, corner), {});
    const Vec3 deflection = 2e-3 * random_direction(random), rotation = 0.2 * random_direction(random);
    const BondedForce a = one.at(deflection, rotation), b = other.at(deflection, rotation);
    ASSERT_LT(distance(a.force, b.force), 1e-9 * length(a.force));
    ASSERT_LT(distance(a.torque, b.torque), 1e-9 * length(a.torque));
  }
}

TEST(BondedResponse, ClosedTranslationDoesNoWork) {
  const Opened box(box_content(bonded(false)));
  std::mt19937 random(7);
  for (int trial = 0; trial < 20; ++trial) {
    const Response3D response(box.view, 0, on_top(box.view, random), {});
    Vec3 corner[3];
    for (Vec3& c : corner) c = draw_vector(random, 2 * kDepthScale);
    double work = 0, gross = 0;
    for (int side = 0; side < 3; ++side) {
      constexpr int kSteps = 4000;
      const Vec3 step = (1.0 / kSteps) * (corner[(side + 1) % 3] - corner[side]);
      for (int k = 0; k < kSteps; ++k) {
        const double w = dot(response.at(corner[side] + (k + 0.5) * step).force, step);
        work += w;
        gross += std::abs(w);
      }
    }
    EXPECT_LT(std::abs(work), 1e-6 * gross);
  }
}

// The trapezoidal rule is exact to round-off for smooth periodic functions.
TEST(BondedResponse, ClosedRotationDoesNoWorkToRoundOff) {
  const Opened box(box_content(bonded(false)));
  std::mt19937 random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const Response6D response(box.view, 0, on_top(box.view, random), {});
    ASSERT_GT(response.rotated(), 0.0);
    const Vec3 deflection = draw_vector(random, kDepthScale);
    const Vec3 middle = draw_vector(random, 0.25), cosine = draw_vector(random, 0.15), sine = draw_vector(random, 0.15);
    double work = 0, gross = 0;
    constexpr int kSteps = 240;
    for (int k = 0; k < kSteps; ++k) {
      const double s = 2 * pi * k / kSteps;
      const Vec3 theta = middle + std::cos(s) * cosine + std::sin(2 * s) * sine;
      const Vec3 rate = -std::sin(s) * cosine + 2 * std::cos(2 * s) * sine;
      const double power = dot(response.at(deflection, theta).torque, angular_velocity(theta, rate));
      work += power;
      gross += std::abs(power);
    }
    EXPECT_LT(std::abs(work), 1e-12 * gross);
  }
}

TEST(BondedResponse, ClosedMotionThroughAHalfTurnDoesNoWork) {
  const Opened box(box_content(bonded(false)));
  std::mt19937 random(7);
  for (const double angle : {0.3, 1.5, 2.6}) {
    for (int trial = 0; trial < 8; ++trial) {
      const Response6D response(box.view, 0, on_top(box.view, random), {});
      Vec3 corner[4], rotation[4];
      for (int k = 0; k < 3; ++k) {
        corner[k] = draw_vector(random, 2 * kDepthScale);
        rotation[k] = draw_vector(random, angle);
      }
      corner[3] = corner[0], rotation[3] = rotation[0];
      double work = 0, gross = 0;
      for (int side = 0; side < 3; ++side) {
        // About an axis that is fixed in space, from one rotation to the next.
        constexpr int kSteps = 4000;
        const Pose from = rotation_pose(rotation[side]), to = rotation_pose(rotation[side + 1]);
        const Vec3 step = (1.0 / kSteps) * (corner[side + 1] - corner[side]),
                   turn = (1.0 / kSteps) * rotation_vector((to * inverse(from)).rotation);
        for (int k = 0; k < kSteps; ++k) {
          const Pose now = rotation_pose((k + 0.5) * turn) * from;
          const BondedForce a = response.at(corner[side] + (k + 0.5) * step, rotation_vector(now.rotation));
          const double w = dot(a.force, step) + dot(a.torque, turn);
          work += w;
          gross += std::abs(w);
        }
      }
      EXPECT_LT(std::abs(work), 1e-6 * gross) << angle;
    }
  }
}

TEST(BondedResponse, FullTurnDoesNoWorkAndHasNoJump) {
  const Opened box(box_content(bonded(false)));
  std::mt19937 random(11);
  for (int trial = 0; trial < 10; ++trial) {
    const Response6D response(box.view, 0, on_top(box.view, random), {});
    const Vec3 deflection = draw_vector(random, kDepthScale), axis = random_direction(random);
    const Pose begin = rotation_pose(draw_vector(random, 0.5));
    constexpr int kSteps = 20000;
    double work = 0, gross = 0, torque = 0, force = 0, jump = 0;
    BondedForce before;
    for (int k = 0; k <= kSteps; ++k) {
      const Pose now = rotation_pose((2 * pi * (k + 0.5) / kSteps) * axis) * begin;
      const BondedForce a = response.at(deflection, rotation_vector(now.rotation));
      torque = std::max(torque, length(a.torque));
      force = std::max(force, length(a.force));
      if (k > 0) {
        jump = std::max({jump, distance(a.torque, before.torque) / torque, distance(a.force, before.force) / force});
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

TEST(BondedResponse, TwistIsOpposedUpToAHalfTurnWithABoundedTorque) {
  const Opened box(box_content(bonded()));
  const Response6D response(box.view, 0, runtime::closest_point(box.view, {0, 0, kTop + 1e-4}).at, {});
  double last = 0;
  for (int k = 1; k < 300; ++k) {
    const double angle = pi * k / 300, torque = response.at({}, {0, 0, angle}).torque.z;
    EXPECT_LT(torque, 0);
    if (angle < layout::kMaxRotation) {
      EXPECT_LT(torque, last);
    }
    EXPECT_GT(torque, -1.2 * kMiddle * kTwistStiffness);
    last = torque;
  }
}

TEST(BondedContact6D, TwistAndRollHaveTheSampledTorque) {
  const Opened box(box_content(bonded()));
  Contact contact(box.view, 0);
  const Tick pressed = press(contact, kDepth);
  BondedContact6D bond(box.view, 0, at(kDepth), pressed);
  ASSERT_TRUE(bond.holds());
  const Tick rest = bond.tick(at(kDepth));
  EXPECT_LT(distance(rest.force, pressed.force), 1e-6);
  EXPECT_LT(distance(rest.torque, pressed.torque), 1e-9);
  const auto about_p = [](const Tick& tick, const Pose& pose) {
    return tick.torque - cross(tick.tool_point - pose.translation, tick.force);
  };
  // The deflection along the normal is zero at this depth.
  const double level = kDepth - pressed.force.z / kBondedStiffness;
  const Pose flat = at(level), twisted = at(level, {0, 0, 0.1}), rolled = at(level, {0, 0.1, 0});
  EXPECT_LT(length(about_p(bond.tick(flat), flat)), 1e-9);
  const Tick twist = bond.tick(twisted);
  EXPECT_NEAR(about_p(twist, twisted).z, -0.1 * kMiddle * kTwistStiffness, 1e-8);
  EXPECT_LT(std::hypot(twist.force.x, twist.force.y), 1e-9);
  const Tick roll = bond.tick(rolled);
  EXPECT_NEAR(about_p(roll, rolled).y, -0.1 * kMiddle * kRollStiffness, 1e-8);
  EXPECT_NEAR(roll.force.x, -0.1 * kMiddle * kRollForce, 1e-6);
  EXPECT_EQ(roll.state, State::stick);
  EXPECT_FALSE(roll.extrapolated);
  EXPECT_TRUE(bond.tick(at(level, {0, 2 * kRotated, 0})).extrapolated);
}

TEST(BondedContact6D, FileWithoutTorquesGivesTheForceOfABondedContact) {
  Options options = bonded();
  options.bonded_torque = false;
  const Opened box(box_content(options));
  Contact contact(box.view, 0);
  const Tick pressed = press(contact, kDepth);
  BondedContact6D bond_6d(box.view, 0, at(kDepth), pressed);
  BondedContact bond(box.view, 0, at(kDepth), pressed);
  ASSERT_TRUE(bond_6d.holds() && bond.holds());
  const Pose there = at(-0.001, {0.1, 0.2, 0.3}, 0.001, 0.002);
  const Tick a = bond_6d.tick(there), b = bond.tick(there);
  EXPECT_EQ(distance(a.force, b.force), 0);
  EXPECT_EQ(distance(a.torque, b.torque), 0);
}

TEST(BondedContact6D, TicksAllocateNothingAndStayFinite) {
  const Opened box(box_content(bonded(false)));
  Contact contact(box.view, 0);
  const Tick pressed = press(contact, kDepth);
  const long before = allocations();
  BondedContact6D bond(box.view, 0, at(kDepth), pressed);
  bool finite = bond.holds();
  for (int k = 0; k <= 1000; ++k) {
    const double s = k / 1000.0;
    const Tick tick = bond.tick(at(kDepth - 0.02 * s, {7 * s, -2 * s, 3 * s}, 0.05 * s, 0));
    finite = finite && std::isfinite(length(tick.force)) && std::isfinite(length(tick.torque));
  }
  EXPECT_EQ(allocations() - before, 0);
  EXPECT_TRUE(finite);
}

TEST(RotationVector, IsTheInverseOfTheExponential) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const double sizes[] = {1e-9, 1e-3, 1.0, 3.0, pi - 1e-7};
    const Vec3 theta = sizes[trial % 5] * random_direction(random);
    EXPECT_LT(distance(rotation_vector(rotation_pose(theta).rotation), theta), 1e-8 * length(theta) + 1e-15);
  }
  EXPECT_EQ(length(rotation_vector(Pose{}.rotation)), 0);
  EXPECT_NEAR(length(rotation_vector({-1, 0, 0, 0, -1, 0, 0, 0, 1})), pi, 1e-15);
}

}  // namespace
}  // namespace palpate::bonded_test
