// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts that push less where they slip: by how much, when, and without a gain.
#include <cmath>

#include "palpate/relief.hpp"
#include "tests/runtime/straight_moves.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;

constexpr double kSunk = 3e-3;

Options relieved() {
  Options options = flat();
  options.coupled = 2;
  options.relief = true;
  return options;
}

// The same answers everywhere, and beside it the same without a relief.
class Relief : public ::testing::Test {
protected:
  Relief() : box_(box_content(relieved())), whole_(box_content(whole())), contact_(box_.view, 0) {}

  static Options whole() {
    Options options = relieved();
    options.relief = false;
    return options;
  }
  static Vec3 at(double x, double depth) { return centre(depth, 0.003 + x, 0.002); }
  Tick tick(const Vec3& to) { return contact_.tick(upright(to)); }
  // By small steps; the last of them.
  Tick go(const Vec3& from, const Vec3& to) {
    Tick last;
    move(contact_, from, to, 2e-5, [&](const Pose&, const Tick& tick) { last = tick; });
    return last;
  }
  // N, of a straight push so deep (m), sticking.
  double pushes(double depth) {
    Contact contact(whole_.view, 0);
    move(contact, at(0, -1e-4), at(0, depth));
    return contact.tick(upright(at(0, depth))).force.z;
  }

  const Opened box_, whole_;
  Contact contact_;
};

TEST_F(Relief, IsNoneWhileTheContactSticks) {
  for (const double depth : {0.5e-3, 1e-3, kSunk}) {
    contact_.reset();
    EXPECT_NEAR(go(at(0, -1e-4), at(0, depth)).force.z, pushes(depth), 1e-12) << depth;
  }
}

TEST_F(Relief, TakesOfADrawnContactWhatTheFileSays) {
  go(at(0, -1e-4), at(0, kSunk));
  const Tick slid = go(at(0, kSunk), at(0.012, kSunk));
  ASSERT_EQ(slid.state, State::slide);
  const double counted = kSunk - kRelief * kSunk * kSunk / kDepthScale;
  const double slope = 1 - 2 * kRelief * kSunk / kDepthScale;
  EXPECT_NEAR(slid.depth, counted, 1e-9);
  // The sideways deflection that friction holds has its part in the normal force.
  const runtime::DepthTerms there = contact_.field().at_depth(slid.depth);
  EXPECT_NEAR(slid.force.z, slope * there.normal_force, 2e-2 * there.normal_force);
  EXPECT_LT(slid.force.z, 0.95 * pushes(kSunk));
}

TEST_F(Relief, ComesWithinTheFirstFewReaches) {
  go(at(0, -1e-4), at(0, kSunk));
  double reach = 0, before = pushes(kSunk), first = 0;
  const double all = kSunk - (kSunk - kRelief * kSunk * kSunk / kDepthScale);
  for (double x = 1e-5; x < 0.01; x += 1e-5) {
    const Tick t = tick(at(x, kSunk));
    const double lost = kSunk - t.depth;
    EXPECT_GE(t.depth, kSunk - all - 1e-9);
    EXPECT_LT(std::abs(t.force.z - before), 0.01 * before) << "no step, at " << x;
    before = t.force.z;
    if (reach == 0 && t.state == State::slide) reach = x;
    if (first == 0 && reach > 0 && lost > 0.5 * all) first = x - reach;
  }
  ASSERT_GT(reach, 0);
  // All but 1 / e by kReliefReach of it: half by 0.69 times that.
  EXPECT_NEAR(first / reach, 0.69 * runtime::kReliefReach, 0.03);
}

TEST_F(Relief, RestsWithTheHand) {
  go(at(0, -1e-4), at(0, kSunk));
  const Tick last = go(at(0, kSunk), at(2e-3, kSunk));
  for (int i = 0; i < 100; ++i) {
    const Tick rest = tick(at(2e-3, kSunk));
    EXPECT_EQ(rest.force.z, last.force.z);
    EXPECT_EQ(rest.force.x, last.force.x);
  }
}

// What is new of a deeper contact sticks: the depth that was lost stays lost, and no more.
TEST_F(Relief, StaysWhatItWasOnTheWayDown) {
  go(at(0, -1e-4), at(0, 1e-3));
  const Tick slid = go(at(0, 1e-3), at(6e-3, 1e-3));
  const double lost = 1e-3 - slid.depth;
  EXPECT_NEAR(lost, kRelief * 1e-6 / kDepthScale, 1e-9);
  const Tick deeper = go(at(6e-3, 1e-3), at(6e-3, kSunk));
  EXPECT_NEAR(kSunk - deeper.depth, lost, 0.05 * lost);
}

TEST_F(Relief, GivesNothingBack) {
  runtime::EnergyMeter meter;
  const auto see = [&](const Pose& pose, const Tick& tick) { meter.add(pose, tick); };
  Vec3 from = at(0, -1e-4);
  // Down shallow, aside, deeper, back and up again: what deepens after a slip is the cheapest way to gain.
  for (int k = 0; k < 20; ++k) {
    for (const Vec3& to :
         {at(0, 1e-3), at(2e-3, 1e-3), at(2e-3, kSunk), at(0, kSunk), at(0, 0.8e-3), at(0, 4e-3), at(0, -1e-4)}) {
      move(contact_, from, to, 2e-5, see);
      from = to;
    }
    EXPECT_GT(meter.dissipated(0), 0);
  }
  // Straight down and up along the same line after a slip, again and again without leaving.
  for (const Vec3& to : {at(0, 2e-3), at(3e-3, 2e-3)}) {
    move(contact_, from, to, 2e-5, see);
    from = to;
  }
  double before = meter.dissipated(contact_.stored());
  for (int k = 0; k < 50; ++k) {
    for (const Vec3& to : {at(3e-3, 3.5e-3), at(3e-3, 0.5e-3)}) {
      move(contact_, from, to, 2e-5, see);
      from = to;
    }
    const double now = meter.dissipated(contact_.stored() - contact_.owed());
    EXPECT_GE(now, before - 1e-4 * meter.given()) << k;
    before = now;
  }
}

}  // namespace
}  // namespace palpate
