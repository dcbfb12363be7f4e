// SPDX-License-Identifier: GPL-3.0-or-later
// One tool between two lobes, a stem over both, several tools at once; what adding their forces is wrong by.
#include "palpate/contact/contact_set.hpp"

#include <cmath>

#include "palpate/output/virtual_coupling.hpp"
#include "tests/runtime/allocation_counter.hpp"
#include "tests/runtime/two_lobes.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;
using runtime::ContactsAsOne;
using runtime::SeveralContacts;
using runtime::SeveralTick;
using runtime::SeveralTools;

TEST(Several, ATipBetweenTwoLobesTouchesBoth) {
  for (const bool friction : {false, true}) {
    const Opened body(two_lobes(smooth(friction)));
    SeveralContacts<> both(body.view, 0);
    Contact one(body.view, 0);
    SeveralTick<2> t;
    Tick alone;
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
    EXPECT_EQ(t.touching, 2);
    EXPECT_GT(length(t.force), 0.05);
    // What pulls to one side is balanced but for what the second, found late, is short of.
    EXPECT_LT(std::fabs(t.force.x), 0.1 * t.force.z) << friction;
    EXPECT_GT(std::fabs(alone.force.x), 0.5 * alone.force.z);
    EXPECT_LT(distance(t.each[0].force + t.each[1].force, t.force), 1e-15);
    EXPECT_LT(distance(t.each[0].torque + t.each[1].torque, t.torque), 1e-15);
    for (double z = between() - 4e-3; z < between() + 1e-3; z += kStride) go(z);
    EXPECT_EQ(t.touching, 0);
    EXPECT_EQ(length(t.force), 0);
    EXPECT_LT(largest, 2 * 3000 * kStride) << friction;  // N/m, above any slope of two sample curves
  }
}

// Behind a coupling, too, both lobes are felt: with one of them the tool would be pushed aside.
TEST(Several, ContactsTickAsOneDoes) {
  const Opened body(two_lobes(smooth(true)));
  SeveralContacts<3> apart(body.view, 0);
  ContactsAsOne<3> as_one(body.view, 0), tied(body.view, 0);
  Contact alone(body.view, 0);
  runtime::VirtualCoupling tie({300, 0}), tie_alone({300, 0});
  EXPECT_EQ(as_one.size(), alone.size());
  Tick held, held_alone;
  double work = 0;
  Vec3 felt;
  constexpr double kStride = 1e-5;
  const auto go = [&](double z) {
    const Pose pose = upright({0, 0, z});
    const SeveralTick<3> each = apart.tick(pose);
    const Tick sum = as_one.tick(pose);
    ASSERT_EQ(distance(sum.force, each.force) + distance(sum.torque, each.torque), 0);
    ASSERT_EQ(sum.depth, std::fmax(each.each[0].depth, std::fmax(each.each[1].depth, each.each[2].depth)));
    ASSERT_EQ(sum.touches(), each.touching > 0);
    double limit = 0;
    for (const Tick& tick : each.each) {
      limit += tick.friction_limit;
      const Vec3 aside = runtime::tangential(tick.force, runtime::normal(body.view, tick.at));
      ASSERT_LE(length(aside), tick.friction_limit * (1 + 1e-9));
    }
    ASSERT_EQ(sum.friction_limit, limit);
    const Vec3 before = felt;
    held = tie.tick(tied, pose, 1e-3);
    felt = held.force;
    held_alone = tie_alone.tick(alone, pose, 1e-3);
    work += 0.5 * (before.z + felt.z) * kStride;
  };
  for (double z = between() + 1e-3; z > between() - 5e-3; z -= kStride) go(z);
  EXPECT_EQ(tied.last().touching, 2);
  EXPECT_GT(held.force.z, 0.3);
  EXPECT_LT(std::fabs(held.force.x), 0.1 * held.force.z);
  EXPECT_GT(std::fabs(held_alone.force.x), 0.3 * held_alone.force.z);
  const double given = work;
  work = 0;
  for (double z = between() - 5e-3; z < between() + 1e-3; z += kStride) go(z);
  EXPECT_LE(work, 1.01 * given) << "gave back more than it took";
  EXPECT_EQ(length(held.force), 0);
  EXPECT_EQ(tied.last().touching, 0);
}

// Pressed into one lobe, a tip comes to the other one: felt there from a tenth of a millimetre on, whatever else of the
// first is near (its own rim, which a look turns down).
TEST(Several, ThePlaceBesideAPressedOneIsMetInTime) {
  const Opened body(two_lobes(smooth(false)));
  SeveralContacts<> several(body.view, 0);
  int both = 0, missed = 0;
  double late = 0;
  for (double t = 0; t < 1.4; t += 1e-4) {
    const Pose pose =
        upright({0.0015 * std::sin(5 * t), 0.002 * std::sin(3 * t), between() + 0.002 * std::cos(8 * t) - 0.001});
    double shallower = HUGE_VAL;
    for (const int side : {-1, 1}) {
      runtime::Location found;
      locate_where(
          body.view, pose.translation, [&](const Vec3& p) { return p.x * side > 0; }, found);
      shallower = std::fmin(shallower, kTipRadius - found.signed_distance);
    }
    const SeveralTick<2> tick = several.tick(pose);
    both += shallower > 0;
    missed += shallower > 0 && tick.touching < 2;
    if (tick.touching < 2) late = std::fmax(late, shallower);
  }
  EXPECT_GT(both, 1000);
  EXPECT_LT(missed, 0.15 * both);
  EXPECT_LT(late, 0.02 * kDepthScale);
}

// In and out sideways: the second contact comes, and either may be the one that is left.
TEST(Several, ContactsComeAndGoWithoutAStepAndGiveNoEnergy) {
  for (const int kind : {0, 1, 2, 3}) {
    const bool friction = kind % 2 == 1, served = kind > 1;  // by searches of 0.1 to 0.2 mm before
    const Opened body(two_lobes(smooth(friction)));
    std::mt19937 random(9);
    SeveralContacts<3> several(body.view, 0);
    int twice = 0, changes = 0;
    Vec3 at{0, 0, between() + 1e-3};
    Vec3 last_force;
    double work = 0, gross = 0;
    bool second = false;
    runtime::Places<3> places;
    runtime::SeveralSearch<3> latest, coming;
    int ticks = 0;
    for (int leg = 0; leg < 60; ++leg) {
      const auto share = [&] { return static_cast<double>(random()) / 4294967296.0; };
      Vec3 to{0.008 * (share() - 0.5), 0.008 * (share() - 0.5), between() - 0.004 * share()};
      if (leg % 6 == 5) to = {at.x, at.y, between() + 0.012};
      const int steps = 1 + static_cast<int>(length(to - at) / 5e-6);
      const Vec3 step = (1.0 / steps) * (to - at);
      for (int i = 0; i < steps; ++i) {
        at = at + step;
        if (served && ticks++ % 20 == 0) {
          latest = coming;
          places.pose = upright(at);
          coming = runtime::search(body.view, 0, places);
          if (ticks == 1) latest = coming;
        }
        const SeveralTick<3> t = served ? several.tick(upright(at), latest) : several.tick(upright(at));
        places = runtime::Places<3>::of(upright(at), t);
        ASSERT_LT(distance(t.force, last_force), 3 * 3000 * 5e-6) << leg << ' ' << i;
        const double w = -0.5 * dot(t.force + last_force, step);
        work += w;
        gross += std::fabs(w);
        last_force = t.force;
        changes += second != (t.touching > 1);
        second = t.touching > 1;
        twice += second;
      }
      if (leg % 6 != 5) continue;
      EXPECT_EQ(length(last_force), 0);
      EXPECT_GE(work, -5e-3 * gross) << leg;
      work = gross = 0;
    }
    EXPECT_GT(twice, 1000);
    EXPECT_GT(changes, 10);
  }
}

// On one lobe, and on a flat top, there is one contact, and its force is the plain one to the last bit.
TEST(Several, WhereThereIsNoHollowThereIsOneContact) {
  for (const auto tools : {Options::Tools::sphere, Options::Tools::capsule}) {
    const Opened ball(ball_content(smooth(true, tools))), box(box_content(smooth(true, tools)));
    for (const Opened* body : {&ball, &box}) {
      SeveralContacts<> several(body->view, 0), served(body->view, 0);
      Contact one(body->view, 0), served_one(body->view, 0);
      runtime::Places<2> places;
      const double top = body == &ball ? kBallRadius : kTop;
      for (int i = 0; i < 6000; ++i) {
        const double z = top + kTipRadius + 1e-3 - 4e-3 * std::sin(1e-3 * i), x = 3e-3 * std::sin(2e-3 * i);
        const Pose pose = Pose::from_quaternion(1, 0, tools == Options::Tools::capsule ? 0.9 : 0, 0, {x, 0, z});
        const SeveralTick<2> t = several.tick(pose);
        const Tick plain = one.tick(pose);
        ASSERT_LE(t.touching, 1) << i;
        ASSERT_EQ(distance(t.force, plain.force), 0) << i;
        ASSERT_EQ(distance(t.torque, plain.torque), 0) << i;
        places.pose = pose;
        const auto latest = runtime::search(body->view, 0, places);
        const SeveralTick<2> s = served.tick(pose, latest);
        places = runtime::Places<2>::of(pose, s);
        ASSERT_LE(s.touching, 1) << i;
        ASSERT_EQ(distance(s.force, served_one.tick(pose, latest.first).force), 0) << i;
      }
    }
  }
}

TEST(Several, AStemOverTwoLobesRestsOnBoth) {
  const Opened body(two_lobes(smooth(false, Options::Tools::capsule)));
  SeveralContacts<> several(body.view, 0);
  // The stem along x, its middle over the hollow, over the tops' height less what it dips between them.
  const double reach = kStemLength / 2;
  SeveralTick<2> t;
  const double height = std::sqrt(std::pow(kBallRadius + kTipRadius, 2) - std::pow(kApart - reach, 2));
  for (double z = height + 1e-3; z > height - 3e-3; z -= 2e-6) {
    t = several.tick(Pose::from_quaternion(std::sqrt(0.5), 0, std::sqrt(0.5), 0, {-reach, 0, z}));
  }
  ASSERT_EQ(t.touching, 2);
  EXPECT_LT(t.each[0].body_point.x * t.each[1].body_point.x, 0);
  EXPECT_GT(t.force.z, 0.05);
}

TEST(Several, TheErrorOfAddingIsTheMeasuredOne) {
  using runtime::superposition_error;
  const double measured[] = {0.33, 0.22, 0.11, 0.04};
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(superposition_error(0.002 * (1 << k), 0.002), measured[k], 1e-12);
  double last = 0.5;
  for (double apart = 0; apart < 30; apart += 0.01) {
    EXPECT_LE(superposition_error(apart, 1), last);
    EXPECT_LT(last - superposition_error(apart, 1), 0.01);
    last = superposition_error(apart, 1);
  }
  EXPECT_EQ(superposition_error(1, 0), 0);
}

// Five fingertips: each has the force of its own contact and its own handle; near ones are told apart from far ones.
TEST(Several, ToolsKeepTheirOwnContactsAndSayWhenTheyAreNear) {
  const Opened box(box_content(smooth(true)));
  SeveralTools<5> hand(box.view, {0, 0, 0, 0, 0});
  const Contact fresh(box.view, 0);
  std::vector<Contact> alone(5, fresh);
  const long before = allocations();
  for (const double spacing : {0.02, 0.004}) {
    hand.reset();
    alone.assign(5, fresh);
    std::array<Tick, 5> ticks;
    for (int i = 0; i < 800; ++i) {
      std::array<Pose, 5> poses;
      for (int k = 0; k < 5; ++k) {
        const double angle = 1.2566 * k, out = spacing / 1.1756;
        poses[static_cast<std::size_t>(k)] =
            upright({out * std::cos(angle), out * std::sin(angle), kTop + kTipRadius + 2e-4 - 1e-6 * i - 1e-4 * k});
      }
      ticks = hand.tick(poses);
      for (std::size_t k = 0; k < 5; ++k) {
        const Tick plain = alone[k].tick(poses[k]);
        ASSERT_EQ(distance(ticks[k].force, plain.force), 0);
        ASSERT_EQ(distance(ticks[k].torque, plain.torque), 0);
      }
    }
    EXPECT_EQ(hand.overlap().near(), spacing < 0.01) << hand.overlap().error;
    EXPECT_NEAR(hand.overlap().spacing, spacing, 0.05 * spacing);
  }
  EXPECT_EQ(allocations(), before);
}

TEST(Several, AFaultForgetsEverything) {
  const Opened body(two_lobes(smooth(true)));
  SeveralContacts<> both(body.view, 0);
  for (double z = between() + 1e-3; z > between() - 2e-3; z -= 1e-5) both.tick(upright({0, 0, z}));
  const SeveralTick<2> wrong = both.tick(upright({std::nan(""), 0, 0}));
  EXPECT_EQ(wrong.each[0].state, State::fault);
  EXPECT_EQ(wrong.touching, 0);
  EXPECT_EQ(length(wrong.force), 0);
  EXPECT_EQ(length(both.tick(upright({0, 0, between() - 2e-3})).force), 0);
}

// A search that is none is a fault of all contacts, too: what is told of them is nothing.
TEST(Several, ASearchThatIsNoneIsAFaultOfAll) {
  const Opened body(two_lobes(smooth(true)));
  ContactsAsOne<> both(body.view, 0);
  runtime::Places<2> places;
  runtime::SeveralSearch<2> found;
  for (double z = between() + 1e-3; z > between() - 2e-3; z -= 1e-5) {
    const Pose pose = upright({0, 0, z});
    places = runtime::Places<2>::of(pose, both.last());
    found = runtime::search(body.view, 0, places);
    both.tick(pose, found);
  }
  ASSERT_EQ(both.last().touching, 2);
  const Pose pressed = upright({0, 0, between() - 2e-3});
  for (const bool first : {true, false}) {
    ContactsAsOne<> held = both;
    runtime::SeveralSearch<2> of_another_file = found;
    (first ? of_another_file.first : of_another_file.more).touch.body.at.triangle = body.view.meta->triangle_count;
    EXPECT_EQ(held.tick(pressed, of_another_file).state, State::fault);
    EXPECT_EQ(held.last().touching, 0);
    EXPECT_EQ(length(held.tick(pressed, found).force), 0);
  }
  found.first.pose.translation.x = std::nan("");
  const Tick wrong = both.tick(pressed, found);
  EXPECT_EQ(wrong.state, State::fault);
  EXPECT_EQ(wrong.depth, 0);
  for (const Tick& each : both.last().each) EXPECT_FALSE(each.touches());
}

}  // namespace
}  // namespace palpate
