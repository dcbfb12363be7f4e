// SPDX-License-Identifier: GPL-3.0-or-later
// The simulated plant against closed forms: spring and damper, Coulomb friction, delays, steps, work.
#include "device/simulation/sim_plant.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace palpate::device {
namespace {

/// A mass alone: nothing resists, nothing is rounded or late.
PlantOptions bare() {
  PlantOptions o;
  o.mass = 0.2;
  o.damping = o.friction = o.resolution = o.delay_in = o.delay_out = 0;
  o.hand.mass = o.hand.stiffness = o.hand.damping = 0;
  return o;
}

TEST(SimPlant, SwingsOnTheHandAsADampedOscillator) {
  PlantOptions o = bare();
  o.damping = 0.4;
  o.hand.mass = 0.05;
  o.hand.stiffness = 400;
  o.hand.damping = 0.6;
  o.start = {0.01, -0.004, 0.002};
  SimPlant plant(o);
  const double mass = 0.25, decay = 1.0 / (2 * mass), turn = std::sqrt(400 / mass - decay * decay);
  for (int k = 1; k <= 200; ++k) {
    const double t = 0.005 * k;
    plant.advance(t);
    const double share = std::exp(-decay * t) * (std::cos(turn * t) + decay / turn * std::sin(turn * t));
    EXPECT_NEAR(plant.position().x, 0.01 * share, 0.01 * 1e-5) << t;
    EXPECT_NEAR(plant.position().y, -0.004 * share, 0.004 * 1e-5) << t;
  }
}

TEST(SimPlant, FollowsTheHandsIntent) {
  PlantOptions o = bare();
  o.hand.stiffness = 2000;
  o.hand.damping = 40;
  o.hand.intended = Probing{{0.01, 0, 0}, {0, 0, 0.02}, {0, 0.003, 0}, 0.5, 0.2};
  SimPlant plant(o);
  plant.advance(1.0);
  EXPECT_NEAR(plant.position().z, 0.02, 1e-4);
  EXPECT_NEAR(plant.position().y, 0.003 * std::sin(0.4 * M_PI), 1e-4);
  const Probing probing{{}, {0, 0, 0.02}, {0.001, 0, 0}, 0.7, 0.3};
  for (const double t : {0.1, 0.6, 1.7}) {
    const Vec3 slope = 1e6 * (probing(t + 5e-7).position - probing(t - 5e-7).position);
    EXPECT_LT(length(slope - probing(t).velocity), 1e-8) << t;
  }
}

TEST(SimPlant, SlidesAndComesToRestAsCoulombHasIt) {
  PlantOptions o = bare();
  o.friction = 0.5;
  SimPlant plant(o);
  const Vec3 along = unit(Vec3{1, 2, -2}, {});
  plant.command(0, 2.0 * along);
  plant.advance(0.1);
  const double speed = 1.5 / 0.2 * 0.1, gone = 0.5 * speed * 0.1;
  EXPECT_LT(length(plant.velocity() - speed * along), 1e-9);
  EXPECT_LT(length(plant.position() - gone * along), 1e-4 * gone);
  // Let go: decelerated by friction alone, it stops after M v^2 / (2 f) and stays there to the last bit.
  plant.command(0.1, {});
  plant.advance(0.1 + 1.01 * speed * 0.2 / 0.5);
  EXPECT_EQ(length(plant.velocity()), 0);
  const Vec3 rest = plant.position();
  EXPECT_LT(length(rest - (gone + 0.2 * speed * speed / (2 * 0.5)) * along), 1e-4 * gone);
  plant.advance(2.0);
  EXPECT_EQ(length(plant.position() - rest), 0);
}

TEST(SimPlant, SticksBelowItsFriction) {
  PlantOptions o = bare();
  o.friction = 0.5;
  SimPlant plant(o);
  for (int k = 0; k < 1000; ++k) {
    plant.command(0.001 * k, {0.28 * std::sin(0.3 * k), 0.28 * std::cos(0.7 * k), 0.28});
    plant.advance(0.001 * (k + 1));
    ASSERT_EQ(length(plant.position()), 0);
  }
  plant.command(1.0, {0.3, 0.3, 0.3});
  plant.advance(1.1);
  EXPECT_GT(plant.position().x, 0);
}

TEST(SimPlant, DelaysStepsAndSaturates) {
  PlantOptions o = bare();
  o.delay_in = 0.003;
  o.delay_out = 0.002;
  o.resolution = 50e-6;
  o.peak_force = 4;
  SimPlant plant(o);
  plant.command(0.010, {30, 0, -40});
  double first = 0;
  for (int k = 0; k <= 300; ++k) {
    const double t = 1e-4 * k;
    const Vec3 seen = plant.seen(t);
    EXPECT_NEAR(seen.x / 50e-6, std::round(seen.x / 50e-6), 1e-9);
    EXPECT_NEAR(seen.x, plant.position().x, 25.1e-6);
    if (first == 0 && seen.x != 0) first = t;
  }
  // 2.4 N on 0.2 kg take 2.04 ms to the first step, at half a step.
  EXPECT_NEAR(first, 0.015 + std::sqrt(50e-6 / 12), 1.5e-4);
  EXPECT_NEAR(plant.force().x, 2.4, 1e-12);
  EXPECT_NEAR(plant.force().z, -3.2, 1e-12);
  plant.command(0.03, {std::numeric_limits<double>::quiet_NaN(), 0, 1});
  plant.seen(0.04);
  EXPECT_EQ(length(plant.force()), 0);
}

TEST(SimPlant, CountsTheWorkOfItsMotors) {
  PlantOptions o = bare();
  o.delay_out = 0.001;
  SimPlant plant(o);
  for (int k = 0; k < 500; ++k) {
    plant.command(0.001 * k, {std::sin(0.01 * k), 0.5 * std::cos(0.03 * k), -0.2});
    plant.advance(0.001 * k + 0.0007);
  }
  const double energy = 0.1 * dot(plant.velocity(), plant.velocity());
  EXPECT_NEAR(plant.given(), energy, 1e-12 * energy);
}

TEST(SimPlant, GivesTheSameBitsAgain) {
  PlantOptions o;
  o.hand.intended = Probing{{}, {0, 0, -0.01}, {0.002, 0, 0}, 0.5, 0.2};
  SimPlant a(o), b(o);
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.00025 * k;
    const Vec3 x = a.seen(t), y = b.seen(t);
    ASSERT_TRUE(x.x == y.x && x.y == y.y && x.z == y.z);
    a.command(t, -700.0 * x);
    b.command(t, -700.0 * y);
  }
  EXPECT_NE(a.position().z, 0);
  EXPECT_EQ(a.given(), b.given());
}

TEST(SimPlant, SurvivesCommandsFasterThanAnyLoop) {
  PlantOptions o = bare();
  o.delay_out = 0.05;
  SimPlant plant(o);
  for (int k = 0; k < 1000; ++k) plant.command(1e-5 * k, {0.001 * k, 0, 0});
  plant.advance(0.1);
  EXPECT_NEAR(plant.force().x, 0.999, 1e-12);  // the newest is never the one that is lost
}

TEST(PlantOptions, SayWhatIsWrong) {
  EXPECT_FALSE(PlantOptions().validate());
  const auto wrong = [](auto change) {
    PlantOptions o;
    change(o);
    const auto text = o.validate();
    EXPECT_THROW(SimPlant{o}, std::invalid_argument);
    return text ? *text : std::string();
  };
  EXPECT_NE(wrong([](PlantOptions& o) { o.mass = 0; }).find("mass is 0 kg"), std::string::npos);
  EXPECT_NE(wrong([](PlantOptions& o) { o.friction = std::nan(""); }).find("friction"), std::string::npos);
  EXPECT_NE(wrong([](PlantOptions& o) { o.delay_in = 1; }).find("delay_in"), std::string::npos);
  EXPECT_NE(wrong([](PlantOptions& o) { o.hand.stiffness = -1; }).find("hand.stiffness"), std::string::npos);
  EXPECT_NE(wrong([](PlantOptions& o) { o.start.y = INFINITY; }).find("start"), std::string::npos);
  EXPECT_NE(wrong([](PlantOptions& o) { o.hand.stiffness = 1e6, o.substep = 1e-3; }).find("substep"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::device
