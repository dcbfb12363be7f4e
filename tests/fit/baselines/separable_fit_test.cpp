// SPDX-License-Identifier: GPL-3.0-or-later
// The separable baseline on pairs with known forces: Hertz, shallow sites, noise, tangential forces, bad samples.
#include "precompute/verify/baselines/separable_fit.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "formats/io/error.hpp"
#include "tests/fit/analytic_pair.hpp"

namespace palpate::fit::separable_fit_test {
namespace {

using test::AnalyticPair;
using test::power_law;
using test::samples_of;

constexpr double Z = 0.005;

/// Largest relative error of the normal force between `from` and 1 times `depth`.
double worst_normal(const verify::SeparableField& curves, const AnalyticPair& pair, double depth, double from) {
  double worst = 0;
  for (int k = 0; k <= 400; ++k) {
    const double z = depth * (from + (1 - from) * k / 400);
    const double truth = pair.push(z).z();
    worst = std::max(worst, std::abs(curves.force({0, 0, z}).z() - truth) / truth);
  }
  return worst;
}

void expect_monotone(const verify::SeparableField& curves) {
  EXPECT_EQ(curves.normal[0], 0.0);
  EXPECT_EQ(curves.normal[1], 0.0);
  for (Eigen::Index k = 1; k < curves.normal.size(); ++k) EXPECT_GE(curves.normal[k], curves.normal[k - 1]);
}

TEST(SeparableFit, HertzDownToATwentiethOfTheDepth) {
  const AnalyticPair hertz = power_law(500.0, 1.5);
  const verify::SeparableField curves = verify::fit_separable(samples_of(hertz, Z), Z, 0, "pair");
  const double worst = worst_normal(curves, hertz, Z, 0.05);
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LT(worst, 0.005);
  expect_monotone(curves);
  EXPECT_EQ(curves.force({0, 0, 0}), Eigen::Vector3d::Zero());
}

TEST(SeparableFit, FlatPunch) {
  const AnalyticPair punch = power_law(200.0, 1.0);
  const verify::SeparableField curves = verify::fit_separable(samples_of(punch, Z), Z, 0, "pair");
  EXPECT_LT(worst_normal(curves, punch, Z, 0.05), 0.005);
  expect_monotone(curves);
}

TEST(SeparableFit, StiffeningTissue) {
  // Hertz times an exponential: four times as stiff at full depth.
  AnalyticPair tissue;
  tissue.push = [](double z) { return Eigen::Vector3d(0, 0, 500 * std::pow(z, 1.5) * std::exp(1.4 * z / Z)); };
  const verify::SeparableField curves = verify::fit_separable(samples_of(tissue, Z), Z, 0, "pair");
  EXPECT_LT(worst_normal(curves, tissue, Z, 0.05), 0.005);
}

TEST(SeparableFit, ShallowSiteGoesOnWithItsLastStiffness) {
  const AnalyticPair hertz = power_law(500.0, 1.5);
  for (const double depth : {0.2 * Z, 0.5 * Z, 0.99 * Z}) {
    const verify::SeparableField curves = verify::fit_separable(samples_of(hertz, depth), Z, 0, "pair");
    EXPECT_LT(worst_normal(curves, hertz, depth, 0.05), 0.005) << depth;
    expect_monotone(curves);
    const double force = hertz.push(depth).z(), stiffness = 1.5 * force / depth;
    for (int k = 1; k <= 20; ++k) {
      const double z = depth + (Z - depth) * k / 20;
      const double expected = force + stiffness * (z - depth);
      EXPECT_NEAR(curves.force({0, 0, z}).z(), expected, 0.02 * expected) << depth << ' ' << z;
    }
  }
}

TEST(SeparableFit, FourPointsAreEnoughForHertz) {
  const AnalyticPair hertz = power_law(500.0, 1.5);
  const verify::SeparableField curves = verify::fit_separable(samples_of(hertz, Z, 4), Z, 0, "pair");
  EXPECT_LT(worst_normal(curves, hertz, Z, 0.05), 0.005);
}

TEST(SeparableFit, NoiseIsNotAmplifiedAndStaysMonotone) {
  const AnalyticPair hertz = power_law(500.0, 1.5);
  std::mt19937 random(7);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Sample> samples = samples_of(hertz, Z);
    for (Sample& s : samples) s.force *= 1 + 0.02 * (static_cast<double>(random()) / 4294967296.0 * 2 - 1);
    const verify::SeparableField curves = verify::fit_separable(samples, Z, 0, "pair");
    EXPECT_LT(worst_normal(curves, hertz, Z, 0.05), 0.03);
    expect_monotone(curves);
  }
}

TEST(SeparableFit, SofteningDataStillGiveAMonotoneCurve) {
  AnalyticPair snap;
  snap.push = [](double z) { return Eigen::Vector3d(0, 0, z < 0.6 * Z ? 100 * z : 60 * Z - 40 * (z - 0.6 * Z)); };
  const std::vector<Sample> samples = samples_of(snap, Z);
  const verify::SeparableField curves = verify::fit_separable(samples, Z, 0, "pair");
  expect_monotone(curves);
}

TEST(SeparableFit, LateralForceOfANormalIndentation) {
  AnalyticPair skewed;
  skewed.push = [](double z) -> Eigen::Vector3d {
    return Eigen::Vector3d(-0.05, 0.03, 1.0) * 500 * std::pow(z, 1.5) + Eigen::Vector3d(0, 0.2 * z, 0);
  };
  const verify::SeparableField curves = verify::fit_separable(samples_of(skewed, Z), Z, 0, "pair");
  for (int k = 1; k <= 100; ++k) {
    const double z = Z * k / 100;
    const Eigen::Vector3d truth = skewed.push(z);
    EXPECT_LT((curves.force({0, 0, z}) - truth).norm(), 0.005 * truth.norm()) << z;
  }
}

AnalyticPair skewed_tangential() {
  AnalyticPair pair = power_law(500.0, 1.5);
  pair.push = [](double z) -> Eigen::Vector3d { return Eigen::Vector3d(0.04, -0.02, 1.0) * 500 * std::pow(z, 1.5); };
  pair.growth = [](double z) { return std::sqrt(z / Z); };
  // Not odd: stiffer towards -x, softening with the deflection.
  pair.tangential_x = [](double x) { return -60 * x + 4000 * x * x + 3e6 * x * x * x; };
  pair.tangential_y = [](double y) { return -90 * y; };
  pair.friction = 0.4;
  return pair;
}

TEST(SeparableFit, SkewedTangentialResponse) {
  const AnalyticPair pair = skewed_tangential();
  const std::vector<Sample> samples = samples_of(pair, Z, 12, 3);
  const verify::SeparableField curves = verify::fit_separable(samples, Z, 0.4 * Z, "pair");
  for (const double z : {0.3 * Z, 0.6 * Z, Z}) {
    for (int k = -10; k <= 10; ++k) {
      for (const int axis : {0, 1}) {
        Eigen::Vector3d deflection(0, 0, z);
        deflection[axis] = 0.4 * z * k / 10;
        const Eigen::Vector3d truth = pair.force(deflection);
        EXPECT_LT((curves.force(deflection) - truth).norm(), 0.01 * truth.norm()) << deflection.transpose();
      }
    }
  }
  for (const auto* phi : {&curves.phi_x, &curves.phi_y}) {
    for (Eigen::Index k = 1; k < phi->size(); ++k) EXPECT_LE((*phi)[k], (*phi)[k - 1]);
  }
  for (const auto* growth : {&curves.growth_x, &curves.growth_y}) {
    EXPECT_EQ((*growth)[0], 0.0);
    EXPECT_GE(growth->minCoeff(), 0.0);
    EXPECT_NEAR((*growth)[growth->size() - 1], 1.0, 1e-12);
  }
  EXPECT_NEAR(curves.force({0, 0, Z}).x(), pair.push(Z).x(), 1e-3 * pair.push(Z).z());
}

TEST(SeparableFit, SameSamplesSameBits) {
  std::vector<Sample> samples = samples_of(skewed_tangential(), Z);
  const verify::SeparableField a = verify::fit_separable(samples, Z, 0.4 * Z, "pair"),
                               b = verify::fit_separable(samples, Z, 0.4 * Z, "pair");
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.phi_x, b.phi_x);
  EXPECT_EQ(a.growth_y, b.growth_y);
}

TEST(SeparableFit, BadSamplesNameThePair) {
  const auto message = [](const std::vector<Sample>& samples, double tangential) -> std::string {
    try {
      verify::fit_separable(samples, Z, tangential, "pair 17 (site 5)");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::numerical);
      return error.what();
    }
    return {};
  };
  const AnalyticPair hertz = power_law(500.0, 1.5);
  EXPECT_NE(message({}, 0).find("pair 17 (site 5)"), std::string::npos);
  EXPECT_NE(message(samples_of(hertz, Z), 0.4 * Z).find("tangential pushes"), std::string::npos);
}

}  // namespace
}  // namespace palpate::fit::separable_fit_test
