// SPDX-License-Identifier: GPL-3.0-or-later
// Fits of pairs with known answers: Hertz, a flat punch, shallow sites, noise, sideways answers, bad samples.
#include "precompute/fit/pair_fit.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "formats/error.hpp"
#include "tests/fit/analytic_pair.hpp"

namespace palpate::fit::pair_fit_test {
namespace {

using test::AnalyticPair;
using test::power_law;
using test::samples_of;

constexpr double Z = 0.005;

ModelScales frictionless() {
  ModelScales scales;
  scales.depth = Z;
  return scales;
}

/// Largest relative error of the normal force between `from` and 1 times `depth`.
double worst_normal(const PairCurves& curves, const ModelScales& scales, const AnalyticPair& pair, double depth,
                    double from) {
  double worst = 0;
  for (int k = 0; k <= 400; ++k) {
    const double z = depth * (from + (1 - from) * k / 400);
    const double truth = pair.push(z).z();
    worst = std::max(worst, std::abs(evaluate(curves, scales, {0, 0, z}).z() - truth) / truth);
  }
  return worst;
}

void expect_monotone(const PairCurves& curves) {
  EXPECT_EQ(curves.normal[0], 0.0);
  EXPECT_EQ(curves.normal[1], 0.0);
  for (Eigen::Index k = 1; k < curves.normal.size(); ++k) EXPECT_GE(curves.normal[k], curves.normal[k - 1]);
}

TEST(PairFit, HertzDownToATwentiethOfTheDepth) {
  const AnalyticPair hertz = power_law(500.0, 1.5);
  const PairCurves curves = fit_pair(samples_of(hertz, Z), frictionless(), "pair");
  const double worst = worst_normal(curves, frictionless(), hertz, Z, 0.05);
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LT(worst, 0.005);
  expect_monotone(curves);
  EXPECT_EQ(evaluate(curves, frictionless(), {0, 0, 0}), Eigen::Vector3d::Zero());
}

TEST(PairFit, FlatPunch) {
  const AnalyticPair punch = power_law(200.0, 1.0);
  const PairCurves curves = fit_pair(samples_of(punch, Z), frictionless(), "pair");
  EXPECT_LT(worst_normal(curves, frictionless(), punch, Z, 0.05), 0.005);
  expect_monotone(curves);
}

TEST(PairFit, StiffeningTissue) {
  // Hertz times an exponential: four times as stiff at full depth.
  AnalyticPair tissue;
  tissue.push = [](double z) { return Eigen::Vector3d(0, 0, 500 * std::pow(z, 1.5) * std::exp(1.4 * z / Z)); };
  const PairCurves curves = fit_pair(samples_of(tissue, Z), frictionless(), "pair");
  EXPECT_LT(worst_normal(curves, frictionless(), tissue, Z, 0.05), 0.005);
}

TEST(PairFit, ShallowSiteGoesOnWithItsLastStiffness) {
  const AnalyticPair hertz = power_law(500.0, 1.5);
  for (const double depth : {0.2 * Z, 0.5 * Z, 0.99 * Z}) {
    const PairCurves curves = fit_pair(samples_of(hertz, depth), frictionless(), "pair");
    EXPECT_LT(worst_normal(curves, frictionless(), hertz, depth, 0.05), 0.005) << depth;
    expect_monotone(curves);
    const double force = hertz.push(depth).z(), stiffness = 1.5 * force / depth;
    for (int k = 1; k <= 20; ++k) {
      const double z = depth + (Z - depth) * k / 20;
      const double expected = force + stiffness * (z - depth);
      EXPECT_NEAR(evaluate(curves, frictionless(), {0, 0, z}).z(), expected, 0.02 * expected) << depth << ' ' << z;
    }
  }
}

TEST(PairFit, FourPointsAreEnoughForHertz) {
  const AnalyticPair hertz = power_law(500.0, 1.5);
  const PairCurves curves = fit_pair(samples_of(hertz, Z, 4), frictionless(), "pair");
  EXPECT_LT(worst_normal(curves, frictionless(), hertz, Z, 0.05), 0.005);
}

TEST(PairFit, NoiseIsNotAmplifiedAndStaysMonotone) {
  const AnalyticPair hertz = power_law(500.0, 1.5);
  std::mt19937 random(7);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Sample> samples = samples_of(hertz, Z);
    for (Sample& s : samples) s.force *= 1 + 0.02 * (static_cast<double>(random()) / 4294967296.0 * 2 - 1);
    const PairCurves curves = fit_pair(samples, frictionless(), "pair");
    EXPECT_LT(worst_normal(curves, frictionless(), hertz, Z, 0.05), 0.03);
    expect_monotone(curves);
  }
}

TEST(PairFit, SofteningDataStillGiveAMonotoneCurve) {
  AnalyticPair snap;
  snap.push = [](double z) { return Eigen::Vector3d(0, 0, z < 0.6 * Z ? 100 * z : 60 * Z - 40 * (z - 0.6 * Z)); };
  const std::vector<Sample> samples = samples_of(snap, Z);
  const PairCurves curves = fit_pair(samples, frictionless(), "pair");
  expect_monotone(curves);
  const FitErrors errors = fit_errors(curves, frictionless(), samples);
  EXPECT_GT(*std::max_element(errors.normal.begin(), errors.normal.end()), 0.05) << "and its error is reported";
}

TEST(PairFit, LateralForceOfAStraightPush) {
  AnalyticPair skewed;
  skewed.push = [](double z) -> Eigen::Vector3d {
    return Eigen::Vector3d(-0.05, 0.03, 1.0) * 500 * std::pow(z, 1.5) + Eigen::Vector3d(0, 0.2 * z, 0);
  };
  const PairCurves curves = fit_pair(samples_of(skewed, Z), frictionless(), "pair");
  for (int k = 1; k <= 100; ++k) {
    const double z = Z * k / 100;
    const Eigen::Vector3d truth = skewed.push(z);
    EXPECT_LT((evaluate(curves, frictionless(), {0, 0, z}) - truth).norm(), 0.005 * truth.norm()) << z;
  }
}

AnalyticPair skewed_sideways() {
  AnalyticPair pair = power_law(500.0, 1.5);
  pair.push = [](double z) -> Eigen::Vector3d { return Eigen::Vector3d(0.04, -0.02, 1.0) * 500 * std::pow(z, 1.5); };
  pair.growth = [](double z) { return std::sqrt(z / Z); };
  // Not odd: stiffer towards -x, softening with the deflection.
  pair.sideways_x = [](double x) { return -60 * x + 4000 * x * x + 3e6 * x * x * x; };
  pair.sideways_y = [](double y) { return -90 * y; };
  pair.friction = 0.4;
  return pair;
}

TEST(PairFit, SkewedSidewaysAnswer) {
  ModelScales scales = frictionless();
  scales.sideways = 0.4 * Z;
  const AnalyticPair pair = skewed_sideways();
  const std::vector<Sample> samples = samples_of(pair, Z, 12, 3);
  const PairCurves curves = fit_pair(samples, scales, "pair");
  for (const double z : {0.3 * Z, 0.6 * Z, Z}) {
    for (int k = -10; k <= 10; ++k) {
      for (const int axis : {0, 1}) {
        Eigen::Vector3d deflection(0, 0, z);
        deflection[axis] = 0.4 * z * k / 10;
        const Eigen::Vector3d truth = pair.force(deflection);
        EXPECT_LT((evaluate(curves, scales, deflection) - truth).norm(), 0.01 * truth.norm()) << deflection.transpose();
      }
    }
  }
  for (const auto* phi : {&curves.sideways_x, &curves.sideways_y}) {
    for (Eigen::Index k = 1; k < phi->size(); ++k) EXPECT_LE((*phi)[k], (*phi)[k - 1]);
  }
  for (const auto* growth : {&curves.growth_x, &curves.growth_y}) {
    EXPECT_EQ((*growth)[0], 0.0);
    EXPECT_GE(growth->minCoeff(), 0.0);
    EXPECT_NEAR((*growth)[growth->size() - 1], 1.0, 1e-12);
  }
  EXPECT_NEAR(evaluate(curves, scales, {0, 0, Z}).x(), pair.push(Z).x(), 1e-3 * pair.push(Z).z());
  EXPECT_NEAR(evaluate_friction(curves, scales, 0.3 * Z), 0.4, 1e-6);
  const FitErrors errors = fit_errors(curves, scales, samples);
  EXPECT_EQ(errors.normal.size(), 12U);
  EXPECT_EQ(errors.tangential.size(), 36U);
  EXPECT_LT(*std::max_element(errors.tangential.begin(), errors.tangential.end()), 0.01);
}

TEST(PairFit, SidewaysAnswerOfAShallowSite) {
  ModelScales scales = frictionless();
  scales.sideways = 0.4 * Z;
  const AnalyticPair pair = skewed_sideways();
  const std::vector<Sample> samples = samples_of(pair, 0.4 * Z);
  const FitErrors errors = fit_errors(fit_pair(samples, scales, "pair"), scales, samples);
  EXPECT_LT(*std::max_element(errors.tangential.begin(), errors.tangential.end()), 0.01);
}

TEST(PairFit, ForcesOfSlippingSamplesArePassedOver) {
  ModelScales scales = frictionless();
  scales.sideways = 0.4 * Z;
  std::vector<Sample> samples = samples_of(skewed_sideways(), Z);
  const PairCurves without = fit_pair(samples, scales, "pair");
  const FitErrors errors = fit_errors(without, scales, samples);
  samples.push_back(samples.back());
  samples.back().kind = SampleKind::slipping;
  samples.back().force *= 0.5;
  const PairCurves with = fit_pair(samples, scales, "pair");
  EXPECT_EQ(evaluate(with, scales, {0.1 * Z, 0.2 * Z, 0.8 * Z}),
            evaluate(without, scales, {0.1 * Z, 0.2 * Z, 0.8 * Z}));
  EXPECT_EQ(fit_errors(with, scales, samples).tangential, errors.tangential);
}

TEST(PairFit, SameSamplesSameBits) {
  ModelScales scales = frictionless();
  scales.sideways = 0.4 * Z;
  std::vector<Sample> samples = samples_of(skewed_sideways(), Z);
  const PairCurves a = fit_pair(samples, scales, "pair"), b = fit_pair(samples, scales, "pair");
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.sideways_x, b.sideways_x);
  EXPECT_EQ(a.growth_y, b.growth_y);
}

TEST(PairFit, BadSamplesNameThePair) {
  const auto message = [](std::vector<Sample> samples, const ModelScales& scales) -> std::string {
    try {
      fit_pair(samples, scales, "pair 17 (site 5)");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::numerical);
      return error.what();
    }
    return {};
  };
  const AnalyticPair hertz = power_law(500.0, 1.5);
  EXPECT_NE(message({}, frictionless()).find("pair 17 (site 5)"), std::string::npos);
  std::vector<Sample> samples = samples_of(hertz, Z);
  samples[4].force.z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(samples, frictionless()).find("not finite"), std::string::npos);
  ModelScales scales = frictionless();
  scales.sideways = 0.4 * Z;
  EXPECT_NE(message(samples_of(hertz, Z), scales).find("sideways pushes"), std::string::npos);
}

}  // namespace
}  // namespace palpate::fit::pair_fit_test
