// SPDX-License-Identifier: GPL-3.0-or-later
// The friction limit over depth: predicted where nothing was solved, corrected by the solved ones.
#include "precompute/fit/laws/friction_limit.hpp"

#include "precompute/fit/laws/pair_fit.hpp"
#include "tests/fit/analytic_pair.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace palpate::fit {
namespace {

constexpr double kDepth = 0.004, kMu = 0.3;

// Predicted: mu and a tenth of it more at full depth.
double predicted(double z) { return kMu * (1 + 0.1 * z / kDepth); }

std::vector<Sample> normal_indentation() {
  test::AnalyticPair pair;
  pair.push = [](double z) {
    return Eigen::Vector3d(std::pow(z, 1.5) * Eigen::Vector3d(20, -10, 300));
  };  // a lump to one side
  pair.growth = [](double z) { return std::sqrt(z / kDepth); };
  pair.tangential_x = pair.tangential_y = [](double x) { return -200 * x; };
  pair.friction = kMu;
  std::vector<Sample> samples = test::samples_of(pair, kDepth);
  for (Sample& s : samples) {
    if (s.kind == SampleKind::normal) s.friction_limit = predicted(s.deflection.z());
  }
  return samples;
}

// Drawn along x and aslant by turns. If all of the contact slips, friction is the limit times the normal force at that
// moment, beside the tissue against the tool's flanks; `in_part`: the same force while a part still sticks.
void add_slipping(std::vector<Sample>& samples, double depth, std::initializer_list<double> limits, double reach = 0.5,
                  bool in_part = false) {
  const auto from = std::find_if(samples.begin(), samples.end(), [&](const Sample& s) {
    return s.kind == SampleKind::normal && s.deflection.z() == depth;
  });
  const Eigen::Vector3d base = from->force;
  const double flanks = response::slipping_bias_share(std::sqrt(depth / kDepth)), normal = 1.1 * base.z();
  int turn = 0;
  for (const double limit : limits) {
    const Eigen::Vector2d way = ++turn % 2 != 0 ? Eigen::Vector2d(1, 0) : Eigen::Vector2d(-0.6, 0.8);
    Sample s;
    s.kind = SampleKind::slipping;
    s.deflection << reach * depth * way, depth;
    s.force << normal * (flanks / base.z() * base.head<2>() - (limit > 0 ? limit : 0.1) * way), normal;
    s.friction_limit = limit > 0 && !in_part ? s.force.head<2>().norm() / s.force.z() : 0.0;
    samples.push_back(s);
  }
}

TEST(FrictionLimit, IsWhatWasForetoldWhereNoContactSlippedAsAWhole) {
  std::vector<Sample> samples = normal_indentation();
  add_slipping(samples, kDepth, {0.0, 0.0});
  const auto limits = friction_limits(samples, kDepth);
  ASSERT_EQ(limits.size(), 12U);
  for (const auto& [z, limit] : limits) EXPECT_DOUBLE_EQ(limit, predicted(z));
}

TEST(FrictionLimit, TakesTheMeanOverDirectionsAndIsCorrectedInBetween) {
  std::vector<Sample> samples = normal_indentation();
  const double deep = samples[11].deflection.z(), middle = samples[5].deflection.z();
  add_slipping(samples, middle, {0.0, predicted(middle)}, 0.4);  // it slides, but not as far as it was drawn
  add_slipping(samples, middle, {1.1 * predicted(middle)});
  add_slipping(samples, deep, {0.0, 1.2 * predicted(deep), 0.0, 1.4 * predicted(deep)});
  const auto limits = friction_limits(samples, kDepth);
  ASSERT_EQ(limits.size(), 12U);
  for (const auto& [z, limit] : limits) {
    const double ratio = z < middle ? 1 + 0.1 * z / middle : 1.1 + 0.2 * (z - middle) / (deep - middle);
    EXPECT_NEAR(limit / predicted(z), ratio, 1e-12) << z;
  }
}

// A pair whose deepest push did not slip as a whole keeps the ratio of the deepest one that did.
TEST(FrictionLimit, GoesOnBeyondTheDeepestSolvedOne) {
  std::vector<Sample> samples = normal_indentation();
  const double middle = samples[5].deflection.z();
  add_slipping(samples, middle, {1.1 * predicted(middle)});
  for (const auto& [z, limit] : friction_limits(samples, kDepth)) {
    if (z > middle) {
      EXPECT_NEAR(limit / predicted(z), 1.1, 1e-12);
    }
  }
}

// A contact that stuck in part until the end would have held more, not less.
TEST(FrictionLimit, IsAtLeastWhatAContactHeldThatSlippedInPart) {
  std::vector<Sample> samples = normal_indentation();
  const double middle = samples[5].deflection.z(), deep = samples[11].deflection.z();
  add_slipping(samples, middle, {1.1 * predicted(middle)});
  add_slipping(samples, deep, {1.05 * predicted(deep), 1.05 * predicted(deep)}, 0.5, true);
  EXPECT_NEAR(friction_limits(samples, kDepth).back().second, 1.1 * predicted(deep), 1e-12);
  add_slipping(samples, deep, {1.3 * predicted(deep), 1.4 * predicted(deep)}, 0.6, true);
  EXPECT_NEAR(friction_limits(samples, kDepth).back().second, 1.35 * predicted(deep), 1e-12);
}

TEST(FrictionLimit, IsWhatTheCurveOfThePairGives) {
  std::vector<Sample> samples = normal_indentation();
  const ResponseScales scales{kDepth, 0.4 * kDepth, {5, 4, 3, 3, true}, 16};
  const auto mu = [&](double depth) {
    return Potential(fit_pair(samples, scales, "pair").coefs, scales).friction(depth);
  };
  EXPECT_NEAR(mu(kDepth), predicted(kDepth), 2e-3);
  add_slipping(samples, samples[11].deflection.z(), {1.3 * predicted(kDepth)});
  EXPECT_NEAR(mu(kDepth), 1.3 * predicted(kDepth), 5e-3);
  EXPECT_NEAR(mu(0.02 * kDepth), kMu, 5e-3);
}

}  // namespace
}  // namespace palpate::fit
