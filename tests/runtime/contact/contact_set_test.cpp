// SPDX-License-Identifier: GPL-3.0-or-later
// One tool that touches several walls: both push, contacts come, merge and go without a step and without energy.
#include "palpate/contact/contact_set.hpp"

#include <cmath>

#include "tests/runtime/two_lobes.hpp"

namespace palpate::contact_set_test {
namespace {

using namespace test;
using runtime::Contact;
using runtime::ContactSet;
using runtime::SetSearch;

constexpr double kStiffest = 3000;  // N/m, above any slope of the sample's responses

template <int Most>
int touching(const ContactSet<Most>& set) {
  int count = 0;
  for (const Tick& tick : set.each()) count += tick.touches();
  return count;
}

TEST(ContactSet, TipBetweenTwoLobesIsPushedByBoth) {
  for (const bool friction : {false, true}) {
    const Opened body(two_lobes(smooth(friction)));
    ContactSet<2> both(body.view, 0);
    Contact one(body.view, 0);
    Tick t, alone;
    Vec3 last;
    double largest = 0;
    const auto go = [&](double z) {
      t = both.tick(upright({0, 0, z}));
      alone = one.tick(upright({0, 0, z}));
      largest = std::fmax(largest, distance(t.force, last));
      last = t.force;
    };
    constexpr double kStride = 2e-6;
    for (double z = between() + 1e-3; z > between() - 4e-3; z -= kStride) go(z);
    EXPECT_EQ(touching(both), 2);
    EXPECT_GT(length(t.force), 0.05);
    // The part to one side is balanced but for what the second wall, found late, lacks.
    EXPECT_LT(std::fabs(t.force.x), 0.1 * t.force.z) << friction;
    EXPECT_GT(std::fabs(alone.force.x), 0.3 * alone.force.z);
    EXPECT_LT(distance(both.each()[0].force + both.each()[1].force, t.force), 1e-15);
    EXPECT_LT(distance(both.each()[0].torque + both.each()[1].torque, t.torque), 1e-15);
    for (double z = between() - 4e-3; z < between() + 1e-3; z += kStride) go(z);
    EXPECT_EQ(touching(both), 0);
    EXPECT_EQ(length(t.force), 0);
    EXPECT_LT(largest, 2 * kStiffest * kStride) << friction;
  }
}

TEST(ContactSet, TickIsTheSumOfItsContacts) {
  const Opened body(two_lobes(smooth(true)));
  ContactSet<3> set(body.view, 0);
  EXPECT_EQ(set.size(kDepthScale), Contact(body.view, 0).size(kDepthScale));
  for (double z = between() + 1e-3; z > between() - 5e-3; z -= 1e-5) {
    const Tick sum = set.tick(upright({0, 0, z}));
    Vec3 force, torque;
    double limit = 0, depth = 0;
    for (const Tick& tick : set.each()) {
      if (!tick.touches()) continue;
      force = force + tick.force;
      torque = torque + tick.torque;
      limit += tick.friction_limit;
      depth = std::fmax(depth, tick.depth);
    }
    ASSERT_LT(distance(sum.force, force) + distance(sum.torque, torque), 1e-15);
    ASSERT_NEAR(sum.friction_limit, limit, 1e-15);
    ASSERT_EQ(sum.depth, depth);
  }
  EXPECT_EQ(touching(set), 2);
}

// With one contact alone the coupled tool would be pushed aside.
TEST(ContactSet, CoupledToolIsHeldBetweenTheLobes) {
  const Opened body(two_lobes(smooth(true)));
  ContactSet<3> set(body.view, 0);
  runtime::VirtualCoupling coupling({300, 0});
  Tick held;
  double work = 0;
  Vec3 felt;
  constexpr double kStride = 1e-5;
  const auto go = [&](double z) {
    const Vec3 before = felt;
    held = coupling.tick(set, upright({0, 0, z}), 1e-3);
    felt = held.force;
    work += 0.5 * (before.z + felt.z) * kStride;
  };
  for (double z = between() + 1e-3; z > between() - 5e-3; z -= kStride) go(z);
  EXPECT_EQ(touching(set), 2);
  EXPECT_GT(held.force.z, 0.3);
  EXPECT_LT(std::fabs(held.force.x), 0.1 * held.force.z);
  const double given = work;
  work = 0;
  for (double z = between() - 5e-3; z < between() + 1e-3; z += kStride) go(z);
  EXPECT_LE(work, 1.01 * given) << "gave back more than it took";
  EXPECT_EQ(length(held.force), 0);
}

TEST(ContactSet, WallBesideAPressedOneIsMetInTime) {
  const Opened body(two_lobes(smooth(false)));
  ContactSet<2> set(body.view, 0);
  int both = 0, missed = 0;
  double late = 0;
  for (double t = 0; t < 1.4; t += 1e-4) {
    const Pose pose =
        upright({0.0015 * std::sin(5 * t), 0.002 * std::sin(3 * t), between() + 0.002 * std::cos(8 * t) - 0.001});
    double shallower = HUGE_VAL;
    for (const int side : {-1, 1}) {
      runtime::Location found;
      ASSERT_TRUE(closest_point_where(
          body.view, pose.translation, [&](const Vec3& p) { return p.x * side > 0; }, HUGE_VAL, found));
      shallower = std::fmin(shallower, kTipRadius - found.signed_distance);
    }
    set.tick(pose);
    both += shallower > 0;
    missed += shallower > 0 && touching(set) < 2;
    if (touching(set) < 2) late = std::fmax(late, shallower);
  }
  EXPECT_GT(both, 1000);
  EXPECT_LT(missed, 0.15 * both);
  EXPECT_LT(late, 0.03 * kDepthScale);
}

// In and out sideways: the second contact comes, and either may be the one that is left. Searches, if any, are 20 ticks old.
TEST(ContactSet, ContactsComeAndGoWithoutAStepAndGiveNoEnergy) {
  for (const int kind : {0, 1, 2, 3}) {
    const bool friction = kind % 2 == 1, searched = kind > 1;
    const Opened body(two_lobes(smooth(friction)));
    std::mt19937 random(9);
    ContactSet<3> set(body.view, 0);
    int twice = 0, changes = 0, ticks = 0;
    Vec3 at{0, 0, between() + 1e-3};
    Vec3 last_force;
    double work = 0, gross = 0;
    bool second = false;
    SetSearch<3> latest, coming;
    for (int leg = 0; leg < 60; ++leg) {
      const auto share = [&] { return static_cast<double>(random()) / 4294967296.0; };
      Vec3 to{0.008 * (share() - 0.5), 0.008 * (share() - 0.5), between() - 0.004 * share()};
      if (leg % 6 == 5) to = {at.x, at.y, between() + 0.012};
      const int steps = 1 + static_cast<int>(length(to - at) / 5e-6);
      const Vec3 step = (1.0 / steps) * (to - at);
      for (int i = 0; i < steps; ++i) {
        at = at + step;
        const Pose pose = upright(at);
        if (searched && ticks++ % 20 == 0) {
          latest = coming;
          coming = runtime::search(body.view, 0, set.request(pose));
          if (ticks == 1) latest = coming;
        }
        const Tick t = searched ? set.tick(pose, latest) : set.tick(pose);
        ASSERT_LT(distance(t.force, last_force), 3 * kStiffest * 5e-6) << kind << ' ' << leg << ' ' << i;
        const double w = -0.5 * dot(t.force + last_force, step);
        work += w;
        gross += std::fabs(w);
        last_force = t.force;
        changes += second != (touching(set) > 1);
        second = touching(set) > 1;
        twice += second;
      }
      if (leg % 6 != 5) continue;
      EXPECT_EQ(length(last_force), 0);
      EXPECT_GE(work, -5e-3 * gross) << leg;
      work = gross = 0;
    }
    EXPECT_GT(twice, 1000) << kind;
    EXPECT_GT(changes, 10) << kind;
  }
}

TEST(ContactSet, BodyWithoutAHollowHasOneContactOfTheSameForce) {
  for (const auto tools : {Options::Tools::sphere, Options::Tools::capsule}) {
    const Opened ball(ball_content(smooth(true, tools))), box(box_content(smooth(true, tools)));
    for (const Opened* body : {&ball, &box}) {
      ContactSet<2> set(body->view, 0);
      Contact one(body->view, 0);
      const double top = body == &ball ? kBallRadius : kTop;
      for (int i = 0; i < 6000; ++i) {
        const double z = top + kTipRadius + 1e-3 - 4e-3 * std::sin(1e-3 * i), x = 3e-3 * std::sin(2e-3 * i);
        const Pose pose = Pose::from_quaternion(1, 0, tools == Options::Tools::capsule ? 0.9 : 0, 0, {x, 0, z});
        const Tick t = set.tick(pose), plain = one.tick(pose);
        ASSERT_LE(touching(set), 1) << i;
        ASSERT_EQ(distance(t.force, plain.force), 0) << i;
        ASSERT_EQ(distance(t.torque, plain.torque), 0) << i;
      }
    }
  }
}

TEST(ContactSet, StemOverTwoLobesRestsOnBoth) {
  const Opened body(two_lobes(smooth(false, Options::Tools::capsule)));
  ContactSet<3> set(body.view, 0);
  const double reach = kStemLength / 2;
  Tick t;
  const double height = std::sqrt(std::pow(kBallRadius + kTipRadius, 2) - std::pow(kApart - reach, 2));
  for (double z = height + 1e-3; z > height - 3e-3; z -= 2e-6) {
    t = set.tick(Pose::from_quaternion(std::sqrt(0.5), 0, std::sqrt(0.5), 0, {-reach, 0, z}));
  }
  ASSERT_EQ(touching(set), 2);
  double product = 1;
  for (const Tick& tick : set.each()) product *= tick.touches() ? tick.body_point.x : 1;
  EXPECT_LT(product, 0) << "one on each lobe";
  EXPECT_GT(t.force.z, 0.05);
}

TEST(ContactSet, ContactsOfAMovingBodyHaveTheForceOfTheBodyAtRest) {
  const Opened body(two_lobes(smooth(true)));
  ContactSet<3> rest(body.view, 0), moving(body.view, 0);
  double most = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pose pose = upright({1e-3 * std::sin(0.005 * i), 0, between() + 1e-3 - 3e-3 * std::sin(2e-3 * i)});
    const Pose frame = turned(1e-4 * i, unit(Vec3{1, 2, -1}, {}), {1e-5 * i, 0.5, 0});
    const Tick a = rest.tick(pose), b = moving.tick(frame * pose, runtime::RigidMotion{&body.view, frame});
    ASSERT_LT(distance(frame.rotate(a.force), b.force), 1e-5 * (1 + length(a.force))) << i;
    most = std::fmax(most, length(a.force));
  }
  EXPECT_GT(most, 0.3);
}

// Core points inside the body, some of them deep; a mesh has no skin.
TEST(ContactSet, WallIsFoundWhereTheToolIsDeepest) {
  const Opened box(box_content(smooth(false, Options::Tools::all)));
  for (std::uint32_t tool = 0; tool < 3; ++tool) {
    const runtime::ToolShape<layout::feature_all> shape(box.view, tool);
    for (const double depth : {-5e-4, 5e-4, 2e-3, 4e-3}) {
      const double touch = runtime::search(box.view, tool, upright({0, 0, kTop + 0.01})).touch.clearance;
      for (const double lean : {0.0, 0.2, -0.2}) {
        runtime::WallSearchRequest<2> request;
        request.reach = 0.01;
        request.pose = Pose::from_quaternion(1, lean, 0.5 * lean, 0, {0, 0, kTop + 0.01 - touch - depth});
        double deepest = HUGE_VAL;
        shape.for_each_sample([&](const runtime::CorePoint& core) {
          const Vec3 q = request.pose.apply(core.point);
          deepest = std::fmin(deepest, runtime::closest_point(box.view, q).signed_distance - shape.skin());
        });
        EXPECT_LE(runtime::detail::find_wall(box.view, shape, request).clearance, deepest + 1e-12)
            << tool << ' ' << depth << ' ' << lean;
      }
    }
  }
}

TEST(ContactSet, WrongSearchIsAFaultOfAllContacts) {
  const Opened body(two_lobes(smooth(true)));
  ContactSet<2> set(body.view, 0);
  SetSearch<2> found;
  for (double z = between() + 1e-3; z > between() - 2e-3; z -= 1e-5) {
    const Pose pose = upright({0, 0, z});
    found = runtime::search(body.view, 0, set.request(pose));
    set.tick(pose, found);
  }
  ASSERT_EQ(touching(set), 2);
  const Pose pressed = upright({0, 0, between() - 2e-3});
  for (const bool first : {true, false}) {
    ContactSet<2> held = set;
    SetSearch<2> of_another_file = found;
    (first ? of_another_file.first : of_another_file.more).touch.body.at.triangle = body.view.meta->triangle_count;
    const Tick fault = held.tick(pressed, of_another_file);
    EXPECT_EQ(fault.state, State::fault) << first;
    EXPECT_EQ(fault.fault, runtime::Fault::bad_search) << first;
    EXPECT_EQ(touching(held), 0) << first;
    EXPECT_EQ(length(held.tick(pressed, found).force), 0) << first;
  }
}

TEST(ContactSet, WrongSearchOfAnotherWallIsAFaultBeforeThatWallTouches) {
  const Opened body(ball_content(smooth(false)));
  ContactSet<3> set(body.view, 0);
  SetSearch<3> found;
  for (double z = kBallRadius + kTipRadius + 1e-4; z > kBallRadius + kTipRadius - 1e-4; z -= 1e-5) {
    found = runtime::search(body.view, 0, set.request(upright({0, 0, z})));
    set.tick(upright({0, 0, z}), found);
  }
  ASSERT_EQ(touching(set), 1);
  found.more.touch.body.at.triangle = 2000000000;
  found.more.touch.clearance = -1e-3;
  EXPECT_EQ(set.tick(upright({0, 0, kBallRadius + kTipRadius - 1e-4}), found).fault, runtime::Fault::bad_search);
  EXPECT_EQ(touching(set), 0);
}

TEST(ContactSet, EmptySearchOfAnotherWallBeginsNoContact) {
  const Opened body(ball_content(smooth(false)));
  ContactSet<3> set(body.view, 0);
  SetSearch<3> first;
  for (double z = kBallRadius + kTipRadius + 1e-4; z > kBallRadius + kTipRadius - 2e-3; z -= 1e-5) {
    first.first = runtime::search(body.view, 0, upright({0, 0, z}));
    set.tick(upright({0, 0, z}), first);
    ASSERT_LE(touching(set), 1) << z;
  }
  EXPECT_EQ(touching(set), 1);
}

// The search's walls and their feet are up to two periods old.
TEST(ContactSet, LateSearchesGiveEachWallOneContact) {
  const Opened body(two_lobes(smooth(false)));
  for (const int every : {1, 5, 20}) {
    ContactSet<3> alone(body.view, 0), searched(body.view, 0);
    SetSearch<3> latest, coming;
    double most = 0, worst = 0;
    for (int tick = 0; tick < 3000; ++tick) {
      const Pose pose = upright({0, 0, between() + 5e-4 - 1e-6 * tick});
      if (tick % every == 0) {
        latest = tick > 0 ? coming : runtime::search(body.view, 0, searched.request(pose));
        coming = runtime::search(body.view, 0, searched.request(pose));
      }
      const Tick a = alone.tick(pose), b = searched.tick(pose, latest);
      ASSERT_LE(touching(searched), 2) << every << ' ' << tick;
      most = std::fmax(most, length(a.force));
      worst = std::fmax(worst, distance(a.force, b.force));
    }
    EXPECT_EQ(touching(searched), 2) << every;
    EXPECT_LT(worst, 0.05 * most) << every;
  }
}

TEST(ContactSet, SearchOfAThreadSeparatesTheWallsThatTheSetSeparates) {
  constexpr double kNear = 0.0196;  // m: the feet are 5.6 mm apart
  const Opened body(two_lobes(smooth(false), kNear));
  ContactSet<3> alone(body.view, 0), searched(body.view, 0);
  for (double depth = -5e-4; depth < 2e-3; depth += 1e-6) {
    const Pose pose = upright({0, 0, between(kNear) - depth});
    const Tick a = alone.tick(pose), b = searched.tick(pose, runtime::search(body.view, 0, searched.request(pose)));
    ASSERT_EQ(touching(alone), touching(searched)) << depth;
    ASSERT_LT(distance(a.force, b.force), 0.02 * (1e-3 + length(a.force))) << depth;
  }
  EXPECT_EQ(touching(searched), 2);
}

}  // namespace
}  // namespace palpate::contact_set_test
