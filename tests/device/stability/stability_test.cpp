// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds of stiffness against what is published of them, and against the loop simulated without friction and steps.
#include "device/stability/stability.hpp"

#include "device/stability/closed_loop.hpp"
#include "device/stability/file_stiffness.hpp"
#include "tests/device/stability/stability_cases.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::device {
namespace {

PlantOptions linear(double delay) {
  PlantOptions o;
  o.mass = 0.1;
  o.damping = 1;
  o.friction = o.resolution = 0;
  o.delay_in = 0.3 * delay;
  o.delay_out = 0.7 * delay;
  o.peak_force = 1e6;
  o.hand.mass = 0.02;
  o.hand.stiffness = 300;
  o.hand.damping = 2;
  return o;
}

TEST(PassiveStiffness, IsColgatesAndAbbotts) {
  PlantOptions o = linear(0);
  EXPECT_NEAR(passive_stiffness(o, {0.001, 0}).by_damping, 2 * 1 / 0.001, 1e-9);
  EXPECT_TRUE(std::isinf(passive_stiffness(o, {0.001, 0}).by_friction));
  o.friction = 0.2;
  o.resolution = 1e-4;
  EXPECT_NEAR(passive_stiffness(o, {0.001, 0}, 1).by_friction, 2 * 0.2 / 1e-4, 1e-9);
  EXPECT_NEAR(passive_stiffness(o, {0.001, 0}, 3).by_friction, 2 * 0.2 / (std::sqrt(3) * 1e-4), 1e-9);
  EXPECT_EQ(passive_stiffness(o, {0.001, 0}, 1).least(), 2000);
  // Whole periods of delay: b > K (T / 2 + D); between them never more.
  EXPECT_NEAR(passive_stiffness(linear(0.003), {0.001, 0}).by_damping, 1 / 0.0035, 1e-6);
  for (const double delay : {0.0004, 0.0011, 0.0029}) {
    const double k = passive_stiffness(linear(delay), {0.001, 0}).by_damping;
    EXPECT_LT(k, 1 / (0.0005 + delay));
    EXPECT_GT(k, 1 / (0.001 + delay));
  }
  EXPECT_NEAR(passive_stiffness(linear(0.002), {0.001, 0.001}).by_damping, 1 / 0.0035, 1e-6);
}

// Colgate and Schenkel's condition at every frequency, with whole periods of delay: b > T / 2 Re((1 - e^-jx) H) / (1 -
// cos x), H = K e^-jnx.
TEST(PassiveStiffness, MeetsColgatesConditionAtEveryFrequency) {
  for (int n = 0; n < 6; ++n) {
    const double stiffness = passive_stiffness(linear(0.001 * n), {0.001, 0}).by_damping;
    double most = 0;
    for (double x = 1e-3; x < 3.1415; x += 1e-3) {
      const double re = std::cos(n * x) - std::cos((n + 1) * x);
      most = std::max(most, 0.0005 * stiffness * re / (1 - std::cos(x)));
    }
    EXPECT_NEAR(most, 1, 1e-4) << n;
  }
}

TEST(OnsetOfOscillation, SeparatesWhatSettlesFromWhatDoesNot) {
  for (const double delay : {0.0, 0.0004, 0.001, 0.0037}) {
    for (const double period : {0.001, 0.00025}) {
      const PlantOptions o = linear(delay);
      const LoopTiming timing{period, 0};
      const Onset onset = onset_of_oscillation(o, timing, HUGE_VAL);
      EXPECT_TRUE(settles(o, timing, 0.999 * onset.stiffness)) << delay;
      EXPECT_FALSE(settles(o, timing, 1.001 * onset.stiffness)) << delay;
      // The same loop in time: a linear spring, no friction, no steps.
      for (const double share : {0.97, 1.03}) {
        Trial trial;
        trial.plant = o;
        trial.timing = timing;
        trial.amplitude = {0.0003, 0, 0};
        trial.frequency = onset.frequency;
        const double k = share * onset.stiffness;
        trial.response = [k](const Vec3& p, double) { return -k * p; };
        EXPECT_EQ(run_trial(trial).oscillates(1e-5), share > 1) << delay << ' ' << period << ' ' << k;
      }
    }
  }
}

TEST(OnsetOfOscillation, FollowsFromPhaseAloneForAContinuousLoop) {
  // A period of 10 us and 5 ms of delay: M s^2 + B s + Kh + K e^(-s D) on the imaginary axis.
  const PlantOptions o = linear(0.005);
  const Onset onset = onset_of_oscillation(o, {1e-5, 0}, HUGE_VAL);
  const double w = 2 * M_PI * onset.frequency, late = 0.005 + 0.5e-5;
  EXPECT_NEAR(onset.stiffness * std::sin(w * late) / (3 * w), 1, 1e-3);
  EXPECT_NEAR((onset.stiffness * std::cos(w * late) + 300) / (0.12 * w * w), 1, 1e-3);
}

TEST(OnsetOfOscillation, FrictionRaisesItTheMoreTheSmallerTheMotion) {
  PlantOptions o = linear(0.002);
  double last = onset_of_oscillation(o, {0.001, 0}, HUGE_VAL).stiffness;
  o.friction = 0.1;
  for (const double amplitude : {1.0, 0.01, 0.003, 0.001}) {
    const double k = onset_of_oscillation(o, {0.001, 0}, amplitude).stiffness;
    EXPECT_GT(k, last) << amplitude;
    last = k;
  }
}

TEST(OnsetOfOscillation, IsAtOnceWithoutAnyDamping) {
  PlantOptions o = linear(0.001);
  o.damping = o.hand.damping = 0;
  EXPECT_EQ(onset_of_oscillation(o, {0.001, 0}, HUGE_VAL).stiffness, 0);
  EXPECT_EQ(passive_stiffness(o, {0.001, 0}).least(), 0);
}

// A softened contact lets the handle rest deeper than the full one would. Whoever swings it has to bring it there: a
// leap against 3 N would be 1.4 mJ of work done in no time, which no loop could take back.
TEST(Trial, GivesTheHandNothingWithThePassivityControllerAndMakesNoMoreThanItsBound) {
  const std::vector<test::NamedHand> grips = test::hands();
  const std::vector<test::ContactLaw> laws = test::plain_laws();
  ASSERT_EQ(laws[0].name, "wall");
  for (const double stiffness : {388.0, 1295.0}) {
    const test::StabilityCase c{find_sim_kind("sim-premium"), &laws[0], &grips[0], 1000, 0.004};
    const double scale = test::scale_of(c, stiffness);
    test::Made made;
    const Swing swing = test::swing(c, scale, test::controlled(c, laws[0].make(scale), made));
    EXPECT_LE(swing.to_hand, test::kTrace) << stiffness;
    EXPECT_FALSE(swing.oscillates(c.kind->plant.resolution)) << stiffness;
    EXPECT_GT(made.most, test::kTrace) << stiffness;
    EXPECT_LE(made.most, made.bound) << stiffness;
  }
}

TEST(LoopTiming, SaysWhatIsWrong) {
  EXPECT_FALSE((LoopTiming{0.001, 0.0001}.validate()));
  EXPECT_TRUE((LoopTiming{0, 0}.validate()));
  EXPECT_TRUE((LoopTiming{0.001, -1}.validate()));
  Trial trial;
  trial.timing.period = NAN;
  EXPECT_THROW(run_trial(trial), std::invalid_argument);
  trial = {};
  trial.arrive = 2;
  EXPECT_THROW(run_trial(trial), std::invalid_argument);
}

TEST(Slope, IsTheSpectralNorm) {
  const Vec3 diagonal[3] = {{3, 0, 0}, {0, -7, 0}, {0, 0, 2}};
  EXPECT_NEAR(slope_of(diagonal).norm, 7, 1e-12);
  EXPECT_NEAR(std::fabs(slope_of(diagonal).direction.y), 1, 1e-12);
  // A shear: singular values of [[1, 1], [0, 1]] are the golden ratio and its inverse.
  const Vec3 shear[3] = {{1, 0, 0}, {1, 1, 0}, {0, 0, 0}};
  EXPECT_NEAR(slope_of(shear).norm, 0.5 * (1 + std::sqrt(5)), 1e-9);
  const Vec3 nothing[3] = {};
  EXPECT_EQ(slope_of(nothing).norm, 0);
}

}  // namespace
}  // namespace palpate::device
