// SPDX-License-Identifier: GPL-3.0-or-later
// The passivity observer against the energy that a held and delayed spring makes; what the controller does and leaves.
#include <cmath>
#include <limits>
#include <vector>

#include "palpate/output/output_chain.hpp"
#include "palpate/output/passivity_controller.hpp"
#include "tests/runtime/allocation_counter.hpp"
#include "tests/runtime/support.hpp"

namespace palpate::passivity_test {
namespace {

using namespace test;
using runtime::OutputChain;
using runtime::output::Limit;
using runtime::output::PassivityController;
using runtime::output::PassivityOptions;
using runtime::output::SentForces;

constexpr double kTick = 1e-3, kPi = 3.14159265358979, kStiff = 2000, kFar = 1e-3, kOmega = 60;

using Out = OutputChain<PassivityController>;

PassivityOptions watching(double delay) {
  PassivityOptions options;
  options.delay = delay;
  options.trace = 1e5;  // the force stays as it is
  return options;
}

/// A spring that is swung for some cycles along a slanted line.
double made_by(Out& out, double cycles, double stiffness = kStiff) {
  const Vec3 along = unit(Vec3{1, -2, 2}, {});
  const int ticks = static_cast<int>(cycles * 2 * kPi / kOmega / kTick);
  for (int k = 0; k <= ticks; ++k) {
    const Vec3 position = kFar * std::sin(kOmega * k * kTick) * along;
    out(-stiffness * position, kTick, position);
  }
  return out.step<PassivityController>().made();
}

// A force -K x held for T and late by D gives out pi K A^2 sin(w (D + T / 2)) sinc(w T / 2) a cycle.
TEST(PassivityController, HeldAndDelayedSpringHasItsClosedFormEnergy) {
  for (const double delay : {0.0, 0.00037, 0.001, 0.0042}) {
    Out out{PassivityController(watching(delay))};
    const double half = 0.5 * kOmega * kTick;
    const double cycle = kPi * kStiff * kFar * kFar * std::sin(kOmega * (delay + 0.5 * kTick)) * std::sin(half) / half;
    EXPECT_NEAR(made_by(out, 20), 20 * cycle, 0.01 * 20 * cycle) << delay;
  }
}

TEST(PassivityController, EnergyThatDampingDissipatesDoesNotReduceTheForce) {
  PassivityOptions options;
  options.delay = 0.002;
  options.damping = 1.01 * kStiff * 0.0025;  // b > K (T / 2 + D)
  Out out{PassivityController(options)};
  made_by(out, 20);
  EXPECT_LT(out.step<PassivityController>().made(), 1e-6);
  EXPECT_GT(out.step<PassivityController>().share(), 0.99);
  options.damping *= 0.8;
  Out tight{PassivityController(options)};
  made_by(tight, 20);
  EXPECT_LT(tight.step<PassivityController>().share(), 0.9);
}

TEST(PassivityController, HalfOfTheNeededDampingGivesHalfOfTheStiffness) {
  PassivityOptions options;
  options.delay = 0.002;
  options.damping = 0.5 * kStiff * 0.0025;
  Out out{PassivityController(options)};
  made_by(out, 50);
  // With half the damping that the spring would need, half of the spring.
  EXPECT_NEAR(out.step<PassivityController>().share(), 0.5, 0.01);
  EXPECT_LT(out.step<PassivityController>().made(), 2 * options.trace);
}

// Pressed slowly, then pulled away at once: what is on its way cannot be recalled, and is no more than the bound says.
TEST(PassivityController, SuddenPullStaysBelowTheBound) {
  for (const double delay : {0.0, 0.0007, 0.004, 0.015}) {
    for (const double speed : {0.2, 1.0}) {
      PassivityOptions options;
      options.delay = delay;
      Out out{PassivityController(options)};
      double depth = 0, most = 0;
      for (int k = 0; k < 3000; ++k) {
        depth += kTick * (k < 2000 ? 1e-6 : -speed);
        out({0, 0, depth > 0 ? 1e6 * depth : 0}, kTick, {0, 0, -depth});
        most = std::fmax(most, out.step<PassivityController>().made());
        ASSERT_LE(out.step<PassivityController>().made(), out.step<PassivityController>().bound())
            << delay << ' ' << speed << ' ' << k;
      }
      EXPECT_GT(most, options.trace) << delay << ' ' << speed;
    }
  }
  // It is the trace alone where nothing moves.
  Out out{PassivityController(PassivityOptions())};
  for (int k = 0; k < 100; ++k) out({1, 2, 3}, kTick, {});
  EXPECT_EQ(out.step<PassivityController>().bound(), PassivityOptions().trace);
}

// More forces on their way than are remembered apart: the motors' energy is counted as if nothing were joined, or more.
TEST(PassivityController, FastLoopCountsTheForcesOfTheWholeDelay) {
  constexpr double kDelay = 0.02, kSlow = 50;  // s, rad/s
  for (const double rate : {1e3, 1e4, 1.25e4, 2e4, 1e5}) {
    Out watches{PassivityController(watching(kDelay))};
    PassivityOptions options;
    options.delay = kDelay;
    options.trace = 3e-3;
    Out acts{PassivityController(options)};
    const auto late = static_cast<std::size_t>(std::lround(kDelay * rate));
    std::vector<double> sent, held;  // N
    double motors = 0, checked = 0, last = 0;
    const int ticks = static_cast<int>(20 * 2 * kPi / kSlow * rate);
    for (int i = 0; i <= ticks; ++i) {
      const double at = -1e-3 * (1 - std::cos(kSlow * i / rate)), way = at - last;
      last = at;
      if (sent.size() > late) {
        motors += sent[sent.size() - 1 - late] * way;
        checked += held[held.size() - 1 - late] * way;
      }
      sent.push_back(watches({0, 0, -500 * at}, 1 / rate, {0, 0, at}).z);
      held.push_back(acts({0, 0, -500 * at}, 1 / rate, {0, 0, at}).z);
      ASSERT_LE(checked, acts.step<PassivityController>().bound()) << rate << ' ' << i;
    }
    EXPECT_GT(motors, 0.02) << rate;
    EXPECT_GE(watches.step<PassivityController>().made(), motors * (1 - 1e-6)) << rate;
    EXPECT_LE(watches.step<PassivityController>().made(), motors * 1.02) << rate;
  }
}

// A clock whose steps are below what the time's sum resolves, or next to nothing.
TEST(PassivityController, TinyTimeStepsStayFiniteAndLoseNoEnergy) {
  for (const double delay : {0.0, 0.003}) {
    for (const double step : {1e-19, 1e-300, 5e-324, 1e-17}) {
      Out out{PassivityController(watching(delay))};
      for (int i = 0; i < 1000; ++i) out({0, 0, 1}, kTick, {0, 0, 1e-5 * i});
      double made = out.step<PassivityController>().made();
      for (int i = 0; i < 1000; ++i) {
        const Vec3 force = out({0, 0, 1}, step, {0, 0, 1e-2 - 1e-5 * i});
        ASSERT_TRUE(std::isfinite(length(force)));
        ASSERT_GE(out.step<PassivityController>().made(), made - 1e-12)
            << "a force that goes on gives what the contact does";
        made = out.step<PassivityController>().made();
      }
      EXPECT_NEAR(distance(out({0, 0, 1}, kTick, {}), {0, 0, 1}), 0, 1e-3);
    }
  }
}

TEST(SentForces, NoWorkIsCountedBeforeTheFirstForce) {
  constexpr double kDelay = 0.005;
  SentForces sent;
  sent.advance(kTick);
  sent.send({1, 0, 0}, kTick, kDelay);
  for (int k = 0; k < 5; ++k) {
    sent.advance(kTick);
    EXPECT_EQ(sent.work(kTick, kDelay, {1e-3, 0, 0}), 0) << k;
    sent.send({1, 0, 0}, kTick, kDelay);
  }
  sent.advance(kTick);
  EXPECT_NEAR(sent.work(kTick, kDelay, {1e-3, 0, 0}), 1e-3, 1e-12);
}

TEST(PassivityController, ShareRisesOnlyWithoutForce) {
  PassivityOptions options;
  options.delay = 0.003;
  options.friction = 0.05;
  Out out{PassivityController(options)};
  double last = 1;
  for (int k = 0; k < 400; ++k) {
    const Vec3 position{kFar * std::sin(kOmega * k * kTick), 0, 0};
    out(Vec3{5, 0, 0} - kStiff * position, kTick, position);
    EXPECT_LE(out.step<PassivityController>().share(), last);
    last = out.step<PassivityController>().share();
  }
  EXPECT_LT(last, 0.1);
  // Friction on a free way dissipates the energy that was made: 0.05 mJ over 0.05 N are 1 mm.
  for (int k = 0; k < 400; ++k) out({}, kTick, {0, 1e-5 * k, 0});
  EXPECT_EQ(out.step<PassivityController>().share(), 1);
  EXPECT_EQ(distance(out({1, 2, 3}, kTick, {0, 4e-3, 0}), {1, 2, 3}), 0);
}

/// Shares of the force at the bottoms of presses on a wall of 500 N/m: 5 mm at 50 mm/s, then `free` ticks without it.
std::vector<double> shares_of_presses(const PassivityOptions& options, int presses, int free) {
  Out out{PassivityController(options)};
  std::vector<double> shares;
  for (int press = 0; press < presses; ++press) {
    for (int k = 0; k < 200 + free; ++k) {
      const double depth = 5e-5 * std::fmax(0, 100 - std::abs(k - 100));
      out({0, 0, 500 * depth}, kTick, {0, 0, -depth});
      EXPECT_LE(out.step<PassivityController>().made(), out.step<PassivityController>().bound());
      if (k == 100) shares.push_back(out.step<PassivityController>().share());
    }
  }
  return shares;
}

// A device of which nothing is known: a hand that was free for a while has lost what it was given.
TEST(PassivityController, PauseResetsTheEnergy) {
  const std::vector<double> shares = shares_of_presses({}, 6, 600);
  EXPECT_GT(shares[0], 0.2);
  for (const double share : shares) EXPECT_NEAR(share, shares[0], 0.02);
  // A pause that is too short counts for nothing, nor does any for a hand of which nothing is known, either.
  PassivityOptions any_hand;
  any_hand.pause = HUGE_VAL;
  for (const std::vector<double>& muted : {shares_of_presses({}, 6, 400), shares_of_presses(any_hand, 6, 5000)}) {
    EXPECT_EQ(muted[0], shares[0]);
    for (std::size_t k = 2; k < muted.size(); ++k) EXPECT_LT(muted[k], 0.01);
  }
  // Damping of K T / 2 dissipates it all.
  PassivityOptions damped;
  damped.damping = 0.26;
  for (const double share : shares_of_presses(damped, 6, 0)) EXPECT_EQ(share, 1);
}

TEST(PassivityController, InputThatIsNotFiniteResetsTheController) {
  OutputChain<Limit, PassivityController> out(Limit{3}, PassivityController(watching(0.001)));
  EXPECT_NEAR(length(out({30, 40, 0}, kTick, {})), 3, 1e-3);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(length(out({1, 0, 0}, kTick, {nan, 0, 0})), 0);
  EXPECT_EQ(length(out({1, nan, 0}, kTick, {})), 0);
  EXPECT_EQ(length(out({1, 0, 0}, 0, {})), 0);
  EXPECT_EQ(out.step<PassivityController>().made(), 0);
  // A leap while nothing was known is no motion.
  EXPECT_EQ(distance(out({1, 0, 0}, kTick, {7, 0, 0}), {1, 0, 0}), 0);
  EXPECT_EQ(out.step<PassivityController>().made(), 0);
}

TEST(PassivityController, AllocatesNothing) {
  Out out{PassivityController(watching(0.004))};
  const long before = allocations();
  made_by(out, 5);
  EXPECT_EQ(allocations(), before);
}

TEST(PassivityController, OptionOutOfRangeIsNamedAndGivesZeroForce) {
  EXPECT_STREQ(PassivityOptions().validate(), nullptr);
  for (const auto change :
       {+[](PassivityOptions& o) { o.delay = 0.03; }, +[](PassivityOptions& o) { o.trace = 0; },
        +[](PassivityOptions& o) { o.damping = NAN; }, +[](PassivityOptions& o) { o.friction = -1; },
        +[](PassivityOptions& o) { o.stiffness = -1; }, +[](PassivityOptions& o) { o.pause = 0; }}) {
    PassivityOptions options;
    change(options);
    EXPECT_NE(options.validate(), nullptr);
    Out out{PassivityController(options)};
    EXPECT_STREQ(out.validate(), options.validate());
    EXPECT_EQ(length(out({1, 0, 0}, kTick, {})), 0);
  }
}

}  // namespace
}  // namespace palpate::passivity_test
