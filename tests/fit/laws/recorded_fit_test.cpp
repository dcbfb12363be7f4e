// SPDX-License-Identifier: GPL-3.0-or-later
// Noisy recordings of a known response: curves within the noise, outliers found one by one, refusals with their cause.
#include "precompute/fit/laws/recorded_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "formats/io/error.hpp"
#include "tests/fit/analytic_pair.hpp"

namespace palpate::test::recorded_fit_test {
namespace {

constexpr double Z = 0.005, kPeak = 0.8;  // m, N

AnalyticPair truth() {
  AnalyticPair pair;
  pair.push = [](double z) -> Eigen::Vector3d {
    return kPeak * std::pow(z / Z, 1.5) * Eigen::Vector3d(0.05, -0.02, 1);
  };
  pair.growth = [](double z) { return std::sqrt(z / Z); };
  pair.tangential_x = [](double x) { return -120 * x; };
  pair.tangential_y = [](double y) { return -90 * y; };
  pair.friction = 0.4;
  return pair;
}

struct Recorded {
  std::vector<Sample> samples;
  std::vector<std::size_t> outliers;  ///< that were put in
};

/// `count` rows by depth drawn evenly, noise in every component (N); every twentieth a gross error: a spike, a dropout,
/// or a force of the wrong sign.
Recorded record(std::size_t count, double noise, bool outliers, bool tangential, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  std::normal_distribution<double> normal;
  const AnalyticPair pair = truth();
  Recorded recorded;
  for (std::size_t k = 0; k < count; ++k) {
    Sample s;
    const double z = Z * (0.01 + 0.99 * share(random));
    s.deflection = {0, 0, z};
    if (tangential && k % 2 == 1) {
      const double angle = 6.28 * share(random), way = 0.4 * z * std::sqrt(share(random));
      s.kind = SampleKind::tangential;
      s.deflection = {way * std::cos(angle), way * std::sin(angle), z};
    }
    s.friction_limit = pair.friction;
    s.force = pair.force(s.deflection) + noise * Eigen::Vector3d(normal(random), normal(random), normal(random));
    if (outliers && k % 20 == 7) {
      const int kind = static_cast<int>(k / 20 % 3);
      s.force = kind == 0 ? Eigen::Vector3d(0.3, 0.5, 2.5) : kind == 1 ? Eigen::Vector3d(-0.4, 0, -0.3) : -s.force;
      if ((s.force - pair.force(s.deflection)).norm() > 0.1 * kPeak) recorded.outliers.push_back(k);
    }
    recorded.samples.push_back(s);
  }
  return recorded;
}

fit::ResponseScales scales(bool friction) {
  if (friction) return {Z, 0.4 * Z, {5, 4, 3, 3, true}, 16};
  return {Z, 0, {5, 4, 0, 0, false}, 16};
}

double worst_error(const fit::PairResponse& response, const fit::ResponseScales& s, double tangential) {
  double worst = 0;
  const AnalyticPair pair = truth();
  for (double z = 0.02 * Z; z <= Z; z += 0.02 * Z) {
    const Eigen::Vector3d at(0.3 * tangential * z, -0.2 * tangential * z, z);
    worst = std::max(worst, (fit::Potential(response.coefs, s).force(at) - pair.force(at)).norm());
  }
  return worst;
}

TEST(RecordedFit, NoiseAndGrossErrorsLeaveTheCurves) {
  constexpr double kNoise = 0.01;  // N, 1.2 % of the peak
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Recorded recorded = record(400, kNoise, true, false, seed);
    ASSERT_GE(recorded.outliers.size(), 15U);
    const fit::RecordedFit fitted = fit::fit_recorded(recorded.samples, Z, scales(false), "recording");
    EXPECT_TRUE(std::includes(fitted.outliers.begin(), fitted.outliers.end(), recorded.outliers.begin(),
                              recorded.outliers.end()));
    EXPECT_LE(fitted.outliers.size(), recorded.outliers.size() + 2);
    EXPECT_LT(worst_error(fitted.response, scales(false), 0), kNoise);
    EXPECT_NEAR(fitted.rms, std::sqrt(3.0) * kNoise, 0.1 * kNoise * std::sqrt(3.0));
    EXPECT_NEAR(fitted.depth, Z, 0.02 * Z);
    // The response if the outliers were kept.
    const fit::PairResponse plain = fit::fit_pair(recorded.samples, scales(false), "plain");
    EXPECT_GT(worst_error(plain, scales(false), 0), 1.5 * kNoise);
  }
}

TEST(RecordedFit, TangentialPushesToo) {
  constexpr double kNoise = 0.008;
  const Recorded recorded = record(800, kNoise, true, true, 4);
  const fit::RecordedFit fitted = fit::fit_recorded(recorded.samples, Z, scales(true), "recording");
  EXPECT_TRUE(std::includes(fitted.outliers.begin(), fitted.outliers.end(), recorded.outliers.begin(),
                            recorded.outliers.end()));
  EXPECT_LE(fitted.outliers.size(), recorded.outliers.size() + 2);
  EXPECT_LT(worst_error(fitted.response, scales(true), 1), 2 * kNoise);
}

TEST(RecordedFit, WithoutNoiseNothingIsAnOutlier) {
  const Recorded recorded = record(200, 0, false, true, 5);
  const fit::RecordedFit fitted = fit::fit_recorded(recorded.samples, Z, scales(true), "recording");
  EXPECT_TRUE(fitted.outliers.empty());
  EXPECT_LT(fitted.rms, 0.005 * kPeak);
}

TEST(RecordedFit, AWeightOfARowCounts) {
  // The heavier of two contradicting recordings prevails.
  Recorded recorded = record(200, 0, false, false, 6);
  for (std::size_t k = 0; k < recorded.samples.size(); k += 2) {
    recorded.samples[k].force *= 1.04;
    recorded.samples[k].weight = 10;
  }
  const fit::RecordedFit fitted = fit::fit_recorded(recorded.samples, Z, scales(false), "recording");
  const double z = 0.7 * Z;
  EXPECT_NEAR(fit::Potential(fitted.response.coefs, scales(false)).force({0, 0, z}).z() / truth().push(z).z(), 1.04, 0.005);
}

TEST(RecordedFit, OnlyTheRatioOfWeightsCounts) {
  Recorded recorded = record(400, 0.005, true, true, 8);
  const fit::RecordedFit one = fit::fit_recorded(recorded.samples, Z, scales(true), "recording");
  for (Sample& s : recorded.samples) s.weight = 1e-3;
  const fit::RecordedFit small = fit::fit_recorded(recorded.samples, Z, scales(true), "recording");
  EXPECT_EQ(one.outliers, small.outliers);
  EXPECT_LT((one.response.coefs - small.response.coefs).norm(), 1e-6 * one.response.coefs.norm());
}

std::string refusal(const std::vector<Sample>& samples, bool friction = false) {
  try {
    fit::fit_recorded(samples, Z, scales(friction), "site 3");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_EQ(std::string(error.what()).rfind("site 3: ", 0), 0U) << error.what();
    return error.what();
  }
  return "fitted without complaint";
}

TEST(RecordedFit, RefusalsNameTheirCause) {
  std::vector<Sample> good = record(200, 0.002, false, false, 7).samples;
  EXPECT_NE(refusal({good.begin(), good.begin() + 7}).find("at least 8 rows"), std::string::npos);

  std::vector<Sample> many(50001, good[0]);
  EXPECT_NE(refusal(many).find("50001 rows, allowed 50000: thin it"), std::string::npos);

  std::vector<Sample> dead = good;
  for (Sample& s : dead) s.force.setZero();
  EXPECT_NE(refusal(dead).find("with a force"), std::string::npos);

  std::vector<Sample> one_axis = record(400, 0.002, false, true, 9).samples;
  std::erase_if(one_axis, [](const Sample& s) { return std::abs(s.deflection.y()) > std::abs(s.deflection.x()); });
  EXPECT_NE(refusal(one_axis, true).find(" 0 and 0 to the contact's"), std::string::npos);

  std::vector<Sample> shallow = good;
  std::erase_if(shallow, [](const Sample& s) { return s.deflection.z() > 0.45 * Z; });
  EXPECT_NE(refusal(shallow).find("less than half of the 5 mm"), std::string::npos);

  std::vector<Sample> gap = good;
  std::erase_if(gap, [](const Sample& s) { return s.deflection.z() < 0.5 * Z; });
  EXPECT_NE(refusal(gap).find("no row between the depths 0 and 2.5"), std::string::npos);

  std::vector<Sample> scattered = good;
  for (std::size_t k = 0; k < scattered.size(); k += 3) scattered[k].force *= k % 2 == 0 ? 0.2 : 2.5;
  const std::string off = refusal(scattered);
  EXPECT_NE(off.find("off"), std::string::npos) << off;

  std::vector<Sample> inverted = good;
  for (Sample& s : inverted) s.force = -s.force;
  EXPECT_NE(refusal(inverted).find("forces on the tool"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test::recorded_fit_test
