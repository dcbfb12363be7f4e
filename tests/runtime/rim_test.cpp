// SPDX-License-Identifier: GPL-3.0-or-later
// Partial slip: Cattaneo and Mindlin's law on a body whose sideways law is linear, Masing's rule, memory, rest.
#include <algorithm>
#include <cmath>

#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;

constexpr double kPressed = 2e-3;

/// On a body that answers alike everywhere, with a sideways law that is linear at one depth.
class RimTest : public ::testing::Test {
protected:
  RimTest() : box_(box_content(options())), contact_(box_.view, 0) {
    Tick pressed;
    for (double z = -0.1e-3; z < kPressed; z += 0.02e-3) pressed = contact_.tick(tip(0, 0, z));
    pressed = contact_.tick(tip(0, 0, kPressed));
    limit_ = pressed.friction_limit;
    // A step far below the rim's limit: what a contact that sticks as a whole answers.
    stiffness_ = -contact_.tick(tip(1e-6, 0, kPressed)).force.x / 1e-6;
    contact_.tick(tip(0, 0, kPressed));
  }

  static Options options() {
    Options options;
    options.coupled = 2;
    options.uniform = options.rim = true;
    options.lateral = false;
    return options;
  }
  static Pose tip(double x, double y, double z) { return upright({0.003 + x, 0.002 + y, kTop + kTipRadius - z}); }

  /// m, at which a contact that sticks as a whole would slip.
  [[nodiscard]] double reach() const { return limit_ / stiffness_; }
  /// Drawn to x (m); the sideways force there in friction limits, against x.
  double draw(double x) {
    Tick tick;
    const int steps = 1 + static_cast<int>(std::abs(x - at_) / (0.01 * reach()));
    for (int k = 1; k <= steps; ++k) tick = contact_.tick(tip(at_ + (x - at_) * k / steps, 0, kPressed));
    at_ = x;
    state_ = tick.state;
    return -std::copysign(std::hypot(tick.force.x, tick.force.y), tick.force.x) / limit_;
  }

  const Opened box_;
  Contact contact_;
  double limit_ = 0, stiffness_ = 0, at_ = 0;
  State state_ = State::free;
};

double mindlin(double share) { return share < 1.5 ? 1 - std::pow(1 - share / 1.5, 1.5) : 1; }

TEST_F(RimTest, SlipsAsMindlinSays) {
  for (double x = 0.05; x < 1.34; x += 0.05) {
    EXPECT_NEAR(draw(x * reach()), mindlin(x), 0.03) << x;
    EXPECT_EQ(state_, State::stick) << x;
  }
  EXPECT_NEAR(draw(1.5 * reach()), 1, 1e-3);
  EXPECT_EQ(state_, State::slide);
  EXPECT_NEAR(draw(3 * reach()), 1, 1e-3);
}

// Back from full slip the same law, twice as large, from there (Masing): full slip the other way after twice the way.
TEST_F(RimTest, TurnsRoundByMasingsRule) {
  draw(4 * reach());
  for (double x = 0.1; x < 2.6; x += 0.1) EXPECT_NEAR(draw((4 - x) * reach()), 1 - 2 * mindlin(x / 2), 0.06) << x;
  EXPECT_EQ(state_, State::stick);
  EXPECT_NEAR(draw(0.5 * reach()), -1, 1e-3);
  EXPECT_EQ(state_, State::slide);
}

// A small loop within closes: the contact remembers where it turned round.
TEST_F(RimTest, SmallLoopsClose) {
  const double there = draw(1.0 * reach());
  draw(0.3 * reach());
  EXPECT_NEAR(draw(1.0 * reach()), there, 1e-6);
}

// In limits times reach: the rim alone slips, by the way less twice its own reach, there and back.
TEST_F(RimTest, ASmallLoopTakesTheWorkOfTheRim) {
  draw(1.0 * reach());
  double last = draw(0.0), work = 0;
  for (int k = 1; k <= 400; ++k) {
    const double force = draw((k <= 200 ? k : 400 - k) / 200.0 * reach());
    work += 0.5 * (force + last) * (k <= 200 ? 0.005 : -0.005);
    last = force;
  }
  EXPECT_NEAR(work, 2 * kRimShare * kRimLimit * (1.0 - 2 * kRimLimit), 1e-3);
}

TEST_F(RimTest, AtRestNothingDrifts) {
  const double there = draw(1.1 * reach());
  Tick tick;
  for (int k = 0; k < 2000; ++k) tick = contact_.tick(tip(1.1 * reach(), 0, kPressed));
  EXPECT_EQ(std::hypot(tick.force.x, tick.force.y) / limit_, there);
}

// Deepening anchors new area unstressed in rim and core alike: the force stays.
TEST_F(RimTest, GoingDeeperKeepsTheForce) {
  const double before = draw(0.8 * reach()) * limit_;
  Tick tick;
  for (double z = kPressed; z < 1.5 * kPressed; z += 0.01e-3) tick = contact_.tick(tip(0.8 * reach(), 0, z));
  EXPECT_NEAR(-tick.force.x, before, 1e-3 * before);
  EXPECT_EQ(tick.state, State::stick);
}

TEST(Rim, HalfARimAndOneOfAFrictionlessFileAreRefused) {
  Options options;
  options.friction = options.lateral = false;
  ResponseFileContent content = box_content(options);
  content.rim_share = kRimShare;
  content.rim_limit = kRimLimit;
  EXPECT_ANY_THROW(encode(content));
  content = box_content(Options());
  for (const auto& [share, limit] : {std::pair{0.5, 0.0}, {0.0, 0.5}, {1.0, 0.5}, {0.5, 1.0}, {-0.1, 0.5}}) {
    content.rim_share = share;
    content.rim_limit = limit;
    EXPECT_ANY_THROW(encode(content)) << share << ' ' << limit;
  }
}

}  // namespace
}  // namespace palpate
