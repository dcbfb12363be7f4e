// SPDX-License-Identifier: GPL-3.0-or-later
// The penalty, the multipliers and the barrier: derivatives, one force by three ways, the ladder that uses them, and
// what a sample says of its own error.
#include "precompute/solve/contact/contact_law.hpp"
#include "precompute/solve/pair/error_estimate.hpp"
#include "precompute/solve/pair/sample_difference.hpp"
#include "tests/support/press.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace palpate::solve {
namespace {

TEST(ContactLaw, PressureAndStiffnessAreDerivatives) {
  const struct {
    ContactLaw law;
    double held;
  } laws[] = {{{1e6, 0, 0}, 0}, {{1e6, 0, 0}, 300}, {{1e6, 1e-3, 1e-4}, 0}};
  for (const auto& [law, held] : laws) {
    for (const double gap : {-2e-3, -1e-4, -1e-6, 5e-5, 1.5e-4, 2.9e-4, 7e-4, 2e-3}) {
      const auto at = [&, &l = law, h = held](double g) { return l.answer(g, h); };
      const double step = 1e-9;
      const ContactAnswer here = at(gap), up = at(gap + step), down = at(gap - step);
      EXPECT_NEAR(-(up.energy - down.energy) / (2 * step), here.pressure, 1e-5 * (1 + here.pressure)) << gap;
      EXPECT_NEAR(-(up.pressure - down.pressure) / (2 * step), here.stiffness, 1e-4 * (1 + here.stiffness)) << gap;
      EXPECT_GE(here.pressure, 0) << gap;
      EXPECT_GE(here.stiffness, 0) << gap;
    }
  }
  EXPECT_EQ(laws[1].law.answer(0.0, 300).pressure, 300);  // what the multiplier is
  EXPECT_EQ(laws[2].law.answer(1e-3, 0).pressure, 0);
}

class ContactMethods : public ::testing::Test {
protected:
  Body body = test::block_body(0.02, 5e3, 0.45);
  ToolScene sphere;
  PairPath path;
  PairOptions options;

  void SetUp() override {
    path.normal_depths = {0.0005, 0.001, 0.0015, 0.002};
    options.mesh_size = 0.5;
    options.growth = 1;
  }
  PairResult press(ContactMethod method) {
    options.method = method;
    return test::press(body, sphere, path, options);
  }
};

// The penalty's give is taken off its depths to first order; multipliers and barrier leave next to none to take off.
TEST_F(ContactMethods, GiveOneForce) {
  const PairResult penalty = press(ContactMethod::penalty);
  ASSERT_TRUE(penalty.outcome.accepted) << penalty.outcome.cause;
  for (const ContactMethod method : {ContactMethod::augmented, ContactMethod::barrier}) {
    const PairResult other = press(method);
    ASSERT_TRUE(other.outcome.accepted) << other.outcome.cause;
    ASSERT_EQ(other.samples.size(), penalty.samples.size());
    EXPECT_LT(sample_difference(penalty.samples, other.samples).normal, 0.01);
    for (std::size_t k = 0; k < other.samples.size(); ++k) {
      const Sample& s = other.samples[k];
      const double give = std::abs(path.normal_depths[k] - s.deflection.z());
      EXPECT_LT(give, 1e-3 * path.normal_depths[k]);
      EXPECT_LT(give, 0.6 * (path.normal_depths[k] - penalty.samples[k].deflection.z()));
      EXPECT_LT(s.penetration, penalty.samples[k].penetration);
      EXPECT_TRUE(method != ContactMethod::barrier || s.penetration == 0);
    }
  }
}

// A penalty so soft that the tool sinks in, on every mesh and when it is made stiffer.
TEST_F(ContactMethods, MultipliersSolveWhatAPenaltyCannot) {
  const PairResult usual = press(ContactMethod::penalty);
  options.penalty = 4;
  const PairResult soft = press(ContactMethod::penalty);
  ASSERT_TRUE(soft.outcome.accepted) << soft.outcome.cause;
  EXPECT_LT(0.002 - soft.samples.back().deflection.z(), 0.5 * (0.002 - usual.samples.back().deflection.z()));
  EXPECT_LT(sample_difference(soft.samples, usual.samples).normal, 0.02);
}

TEST_F(ContactMethods, ARefusalNamesEveryAttempt) {
  options.materials = {fem::Material::neo_hookean(5e3, 0.45)};
  options.materials[0].bulk = std::numeric_limits<double>::quiet_NaN();
  const PairResult r = press(ContactMethod::penalty);
  ASSERT_FALSE(r.outcome.accepted);
  for (const char* rung : {"; finer: ", "; stiffer contact: ", "; augmented Lagrange: ", "; log barrier: "}) {
    EXPECT_NE(r.outcome.cause.find(rung), std::string::npos) << r.outcome.cause;
  }
}

TEST_F(ContactMethods, ACheckComparesWithAFinerMesh) {
  options.check = options.mesh_errors = true;
  path.friction = 0.3;
  path.tangential_depths = {0.002};
  path.tangential_directions = 2;
  const PairResult r = press(ContactMethod::penalty);
  ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
  ASSERT_TRUE(r.check);
  EXPECT_GT(r.check->nodes, 1.3 * r.outcome.nodes);
  EXPECT_EQ(r.check->compared, 4U);
  EXPECT_GT(r.check->difference, 0);
  EXPECT_LT(r.check->difference, 0.05);
  EXPECT_EQ(r.check->within_estimate, 4U);
  options.check = false;
  EXPECT_FALSE(press(ContactMethod::penalty).check);
}

TEST(ErrorEstimate, GrowsWithEachOfItsSources) {
  ErrorSources good;
  good.force = 0.05;
  good.depth = 0.002;
  good.give = 1e-5;
  good.energy_error = 1e-13;
  good.contact_stiffness = 5e3;
  good.points = 400;
  const double least = error_estimate(good);
  EXPECT_GT(least, 0);
  EXPECT_LT(least, 0.02);
  ErrorSources s = good;
  s.points = 20;
  EXPECT_GT(error_estimate(s), 1.5 * least);
  s = good;
  s.give = 1e-4;
  EXPECT_GT(error_estimate(s), 1.5 * least);
  s = good;
  s.energy_error = 1e-8;
  EXPECT_GT(error_estimate(s), 1.5 * least);
}

}  // namespace
}  // namespace palpate::solve
