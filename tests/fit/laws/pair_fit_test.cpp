// SPDX-License-Identifier: GPL-3.0-or-later
// Fits of pairs with known forces: Hertz, a flat punch, shallow sites, noise, tangential forces, bad samples.
#include "precompute/fit/laws/pair_fit.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "formats/io/error.hpp"
#include "palpate/format/response_rules.hpp"
#include "tests/fit/analytic_pair.hpp"

namespace palpate::fit::pair_fit_test {
namespace {

using test::AnalyticPair;
using test::power_law;
using test::samples_of;

constexpr double Z = 0.005;

ResponseScales frictionless() { return {Z, 0, {6, 4, 0, 0, false}, 16}; }
ResponseScales with_friction() { return {Z, 0.4 * Z, {5, 4, 3, 3, true}, 16}; }

Eigen::Vector3d evaluate(const PairResponse& response, const ResponseScales& scales, const Eigen::Vector3d& at) {
  return Potential(response.coefs, scales).force(at);
}

/// Largest relative error of the normal force between `from` and 1 times `depth`.
double worst_normal(const PairResponse& curves, const ResponseScales& scales, const AnalyticPair& pair, double depth,
                    double from) {
  double worst = 0;
  for (int k = 0; k <= 400; ++k) {
    const double z = depth * (from + (1 - from) * k / 400);
    const double truth = pair.push(z).z();
    worst = std::max(worst, std::abs(evaluate(curves, scales, {0, 0, z}).z() - truth) / truth);
  }
  return worst;
}

void expect_monotone(const PairResponse& response) {
  EXPECT_EQ(response::broken_rule(response.coefs.data(), frictionless().degrees, 10), nullptr);
}

TEST(PairFit, HertzDownToATwentiethOfTheDepth) {
  const AnalyticPair hertz = power_law(500.0, 1.5);
  const PairResponse curves = fit_pair(samples_of(hertz, Z), frictionless(), "pair");
  const double worst = worst_normal(curves, frictionless(), hertz, Z, 0.05);
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LT(worst, 0.005);
  expect_monotone(curves);
  EXPECT_EQ(evaluate(curves, frictionless(), {0, 0, 0}), Eigen::Vector3d::Zero());
}

TEST(PairFit, FlatPunch) {
  const AnalyticPair punch = power_law(200.0, 1.0);
  const PairResponse curves = fit_pair(samples_of(punch, Z), frictionless(), "pair");
  EXPECT_LT(worst_normal(curves, frictionless(), punch, Z, 0.05), 0.005);
  expect_monotone(curves);
}

TEST(PairFit, StiffeningTissue) {
  // Hertz times an exponential: four times as stiff at full depth.
  AnalyticPair tissue;
  tissue.push = [](double z) { return Eigen::Vector3d(0, 0, 500 * std::pow(z, 1.5) * std::exp(1.4 * z / Z)); };
  const PairResponse curves = fit_pair(samples_of(tissue, Z), frictionless(), "pair");
  EXPECT_LT(worst_normal(curves, frictionless(), tissue, Z, 0.05), 0.015);
}

TEST(PairFit, ShallowSiteGoesOnWithItsLastStiffness) {
  const AnalyticPair hertz = power_law(500.0, 1.5);
  for (const double depth : {0.2 * Z, 0.5 * Z, 0.99 * Z}) {
    const PairResponse curves = fit_pair(samples_of(hertz, depth), frictionless(), "pair");
    EXPECT_LT(worst_normal(curves, frictionless(), hertz, depth, 0.05), 0.01) << depth;
    expect_monotone(curves);
    const double force = hertz.push(depth).z(), stiffness = 1.5 * force / depth;
    for (int k = 1; k <= 20; ++k) {
      const double z = depth + (Z - depth) * k / 20;
      const double expected = force + stiffness * (z - depth);
      EXPECT_NEAR(evaluate(curves, frictionless(), {0, 0, z}).z(), expected, 0.1 * expected) << depth << ' ' << z;
    }
  }
}

TEST(PairFit, FourPointsAreEnoughForHertz) {
  const AnalyticPair hertz = power_law(500.0, 1.5);
  const PairResponse curves = fit_pair(samples_of(hertz, Z, 4), frictionless(), "pair");
  EXPECT_LT(worst_normal(curves, frictionless(), hertz, Z, 0.05), 0.005);
}

TEST(PairFit, NoiseIsNotAmplifiedAndStaysMonotone) {
  const AnalyticPair hertz = power_law(500.0, 1.5);
  std::mt19937 random(7);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Sample> samples = samples_of(hertz, Z);
    for (Sample& s : samples) s.force *= 1 + 0.02 * (static_cast<double>(random()) / 4294967296.0 * 2 - 1);
    const PairResponse curves = fit_pair(samples, frictionless(), "pair");
    EXPECT_LT(worst_normal(curves, frictionless(), hertz, Z, 0.05), 0.03);
    expect_monotone(curves);
  }
}

TEST(PairFit, SofteningDataStillGiveAMonotoneCurve) {
  AnalyticPair snap;
  snap.push = [](double z) { return Eigen::Vector3d(0, 0, z < 0.6 * Z ? 100 * z : 60 * Z - 40 * (z - 0.6 * Z)); };
  const std::vector<Sample> samples = samples_of(snap, Z);
  const PairResponse curves = fit_pair(samples, frictionless(), "pair");
  expect_monotone(curves);
  const FitErrors errors = fit_errors(curves, frictionless(), samples);
  EXPECT_GT(*std::max_element(errors.normal.begin(), errors.normal.end()), 0.05) << "and its error is reported";
}

TEST(PairFit, TangentialForceOfANormalIndentation) {
  AnalyticPair skewed;
  skewed.push = [](double z) -> Eigen::Vector3d {
    return Eigen::Vector3d(-0.05, 0.03, 1.0) * 500 * std::pow(z, 1.5) + Eigen::Vector3d(0, 0.2 * z, 0);
  };
  const PairResponse curves = fit_pair(samples_of(skewed, Z), frictionless(), "pair");
  for (int k = 1; k <= 100; ++k) {
    const double z = Z * k / 100;
    const Eigen::Vector3d truth = skewed.push(z);
    EXPECT_LT((evaluate(curves, frictionless(), {0, 0, z}) - truth).norm(), 0.005 * truth.norm()) << z;
  }
}

/// Stiffness that grows with the root of the depth, different along x and y, and a bias.
AnalyticPair skewed() {
  AnalyticPair pair = power_law(500.0, 1.5);
  pair.push = [](double z) -> Eigen::Vector3d { return Eigen::Vector3d(0.04, -0.02, 1.0) * 500 * std::pow(z, 1.5); };
  pair.growth = [](double z) { return std::sqrt(z / Z); };
  pair.tangential_x = [](double x) { return -60 * x; };
  pair.tangential_y = [](double y) { return -90 * y; };
  pair.friction = 0.4;
  return pair;
}

TEST(PairFit, TangentialForces) {
  const ResponseScales scales = with_friction();
  const std::vector<Sample> samples = samples_of(skewed(), Z, 12, 3);
  const PairResponse response = fit_pair(samples, scales, "pair");
  EXPECT_EQ(response::broken_rule(response.coefs.data(), scales.degrees, 10), nullptr);
  EXPECT_NEAR(Potential(response.coefs, scales).friction(0.3 * Z), 0.4, 1e-6);
  const FitErrors errors = fit_errors(response, scales, samples);
  EXPECT_EQ(errors.normal.size(), 12U);
  EXPECT_EQ(errors.tangential.size(), 36U);
  EXPECT_LT(*std::max_element(errors.normal.begin(), errors.normal.end()), 0.01);
  EXPECT_LT(*std::max_element(errors.tangential.begin(), errors.tangential.end()), 0.03);
}

TEST(PairFit, ForcesOfSlippingSamplesAreNotFitted) {
  const ResponseScales scales = with_friction();
  std::vector<Sample> samples = samples_of(skewed(), Z);
  const PairResponse without = fit_pair(samples, scales, "pair");
  const FitErrors errors = fit_errors(without, scales, samples);
  samples.push_back(samples.back());
  samples.back().kind = SampleKind::slipping;
  samples.back().force *= 0.5;
  const PairResponse with = fit_pair(samples, scales, "pair");
  EXPECT_EQ(evaluate(with, scales, {0.1 * Z, 0.2 * Z, 0.8 * Z}),
            evaluate(without, scales, {0.1 * Z, 0.2 * Z, 0.8 * Z}));
  EXPECT_EQ(fit_errors(with, scales, samples).tangential, errors.tangential);
}

TEST(PairFit, SameSamplesSameBits) {
  const std::vector<Sample> samples = samples_of(skewed(), Z);
  EXPECT_EQ(fit_pair(samples, with_friction(), "pair").coefs, fit_pair(samples, with_friction(), "pair").coefs);
}

TEST(PairFit, FewerBitsGiveTheCoefficientsOfTheFile) {
  ResponseScales scales = with_friction();
  const std::vector<Sample> samples = samples_of(skewed(), Z);
  const Eigen::VectorXd exact = fit_pair(samples, scales, "pair").coefs;
  scales.bits = 8;
  const Eigen::VectorXd coarse = fit_pair(samples, scales, "pair").coefs;
  EXPECT_EQ(coarse, rounded(exact, scales.degrees, 8, "pair"));
  EXPECT_NE(coarse, exact);
}

TEST(PairFit, BadSamplesNameThePair) {
  const auto message = [](std::vector<Sample> samples, const ResponseScales& scales) -> std::string {
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
  EXPECT_NE(message(samples_of(hertz, Z), with_friction()).find("tangential pushes"), std::string::npos);
}

}  // namespace
}  // namespace palpate::fit::pair_fit_test
