// SPDX-License-Identifier: GPL-3.0-or-later
// Fits of the quadratic potential: laws found again, data that no passive law fits, quantisation, degrees.
#include "precompute/fit/laws/potential_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "formats/io/error.hpp"
#include "palpate/format/response_layout.hpp"
#include "palpate/format/response_rules.hpp"
#include "precompute/fit/laws/potential_degrees.hpp"
#include "precompute/solve/pair/pair.hpp"

namespace palpate::fit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using response::Degrees;

constexpr double Z = 0.004, X = 0.0014;

/// Hertz with a bias, a stiffness that grows, and its coupling.
VectorXd known(const Degrees& d, double coupling = -0.3) {
  const response::Offsets p = response::offsets(d);
  VectorXd c = VectorXd::Zero(p.end);
  for (int k = 0; k < p.bias; ++k) c[k] = 0.4 * k + 0.1 * k * k + 0.05;
  for (int k = p.bias; k < p.stiffness; k += 2) {
    c[k] = 0.05 * (k - p.bias);
    c[k + 1] = -0.03 * (k - p.bias);
  }
  for (int i = 0; d.friction_families && i <= d.stiffness; ++i) {
    c.segment<3>(p.stiffness + 3 * i) << 0.5 + 0.05 * i, 0.03 * i, -0.02;
    if (i >= 2) c.segment<3>(p.coupling + 3 * (i - 2)) << coupling * (0.5 + 0.05 * i), 0.02, 0.01;
  }
  for (int k = p.friction; k < p.end; ++k) c[k] = 0.3 + 0.02 * (k - p.friction);
  return c;
}

/// The bake's rays of a law, and with `paths` its test paths by the law's own rule.
std::vector<Sample> samples_of(const VectorXd& coefs, const ResponseScales& scales, bool paths = false) {
  const Potential law(coefs, scales);
  std::vector<Sample> samples;
  const auto add = [&](SampleKind kind, std::size_t index, const Vector3d& deflection, const Vector2d& held) {
    Sample s;
    s.kind = kind;
    s.index = static_cast<std::uint16_t>(index);
    s.deflection = deflection;
    s.force = law.force(held, deflection.z());
    s.friction_limit = law.friction(deflection.z());
    samples.push_back(s);
  };
  for (int k = 1; k <= 12; ++k) add(SampleKind::normal, std::size_t(k - 1), {0, 0, Z * k * k / 144}, {0, 0});
  std::size_t index = 0;
  for (int level = 1; level <= 4; ++level) {
    const double z = Z * level * level / 16;
    for (int d = 0; d < 8; ++d) {
      for (int k = 1; k <= 3; ++k) {
        const double r = X / Z * z * k / 3, angle = std::numbers::pi * d / 4;
        const Vector2d e(r * std::cos(angle), r * std::sin(angle));
        add(SampleKind::tangential, index++, {e.x(), e.y(), z}, e);
      }
    }
  }
  for (int number = 0; number < (paths ? 2 : 0); ++number) {  // deeper, and less deep, under side load
    const double from = number == 0 ? 0.25 * Z : Z, to = number == 0 ? Z : 0.5 * Z;
    const Vector2d side(0.3 * X * from / Z, 0.2 * X * from / Z);
    const std::size_t first = std::size_t(number) * solve::kPathStride;
    add(SampleKind::path, first, {0, 0, from}, {0, 0});
    for (std::size_t k = 1; k <= 6; ++k) {
      const double share = static_cast<double>(k) / 6, way = std::max(0.0, 1.5 * share - 0.5);
      const Vector2d at = std::min(1.0, 3 * share) * side;
      const double z = from + way * (to - from);
      add(SampleKind::path, first + k, {at.x(), at.y(), z}, z > from ? law.deepened(from, z, at) : at);
    }
  }
  return samples;
}

double worst_error(const VectorXd& coefs, const ResponseScales& scales, const std::vector<Sample>& samples) {
  const FitErrors errors = fit_errors({coefs, 0}, scales, samples);
  double worst = 0;
  for (const auto* list : {&errors.normal, &errors.tangential, &errors.paths}) {
    for (const double e : *list) worst = std::max(worst, e);
  }
  return worst;
}

const Degrees kinds[] = {{5, 0, 3, 3, true}, {4, 3, 2, 1, true}, {6, 4, 4, 0, true}};

TEST(PotentialFit, FindsALawAgain) {
  for (const Degrees& d : kinds) {
    const ResponseScales scales{Z, X, d, 16};
    const std::vector<Sample> samples = samples_of(known(d), scales, true);
    const VectorXd coefs = fit_potential(samples, scales, "pair");
    EXPECT_EQ(response::broken_rule(coefs.data(), d, 10), nullptr);
    EXPECT_LT(worst_error(coefs, scales, samples), 1e-3);
    EXPECT_NEAR(coefs[coefs.size() - 1], known(d)[coefs.size() - 1], 5e-3);
  }
}

TEST(PotentialFit, DataThatNoPassiveLawFitsStillGiveAPassiveOne) {
  for (const double coupling : {-1.8, 1.8}) {
    for (const Degrees& d : kinds) {
      const ResponseScales scales{Z, X, d, 16};
      const VectorXd truth = known(d, coupling);
      ASSERT_NE(response::broken_rule(truth.data(), d, 10), nullptr);
      const std::vector<Sample> samples = samples_of(truth, scales);
      const VectorXd coefs = fit_potential(samples, scales, "pair");
      EXPECT_EQ(response::broken_rule(coefs.data(), d, 10), nullptr) << coupling;
      const double worst = worst_error(coefs, scales, samples);
      EXPECT_GT(worst, 0.005) << "and its error is reported";
      EXPECT_LT(worst, 0.3);
    }
  }
}

TEST(PotentialFit, DataWhoseForceFallsGiveAMonotoneForce) {
  const ResponseScales scales{Z, X, kinds[0], 16};
  VectorXd truth = known(kinds[0]);
  truth[3] = 0.3 * truth[2];
  const VectorXd coefs = fit_potential(samples_of(truth, scales), scales, "pair");
  EXPECT_EQ(response::broken_rule(coefs.data(), kinds[0], 10), nullptr);
}

// The tip of a stem that meets first, then its side: a curve of such bends that the rules bind many coefficients.
TEST(PotentialFit, APushThatTheRulesBindIsFittedAsWellAsTheyAllow) {
  const ResponseScales scales{Z, X, {6, 4, 3, 3, true}, 16};
  std::vector<Sample> samples = samples_of(known(scales.degrees, 0), scales);
  const Potential law(known(scales.degrees, 0), scales);
  const auto stem = [](double z) { return z / Z / (1 + std::exp((0.55 - std::sqrt(z / Z)) / 0.15)); };
  for (Sample& s : samples) s.force.z() += stem(s.deflection.z()) - law.force({0, 0, s.deflection.z()}).z();
  const Potential fitted(fit_potential(samples, scales, "pair"), scales);
  for (const Sample& s : samples) {
    const Vector3d there = fitted.force(s.deflection);
    EXPECT_LT((there - s.force).norm(), 0.06 * std::max(s.force.norm(), 0.02 * stem(Z))) << s.deflection.transpose();
  }
}

TEST(PotentialFit, WholeNumbersKeepTheRulesAndTheForces) {
  std::mt19937 random(11);
  for (const Degrees& d : kinds) {
    const ResponseScales scales{Z, X, d, 16};
    for (const double coupling : {-1.0, -0.5, 0.999, 1.0}) {  // on the very edge, too
      VectorXd truth = known(d, coupling);
      const response::Offsets p = response::offsets(d);
      for (int i = 0; i <= d.stiffness; ++i) {
        const double least = std::min(response::least_stiffness(truth.data(), d, i, 1),
                                      response::least_stiffness(truth.data(), d, i, -1));
        truth[p.stiffness + 3 * i] -= std::min(least, 0.0);
      }
      for (const auto& [bits, error] : {std::pair{16, 5e-3}, {12, 0.08}, {8, 1.0}}) {
        const Quantised q = quantise(truth, d, bits, "pair");
        ASSERT_EQ(q.coefs.size(), static_cast<std::size_t>(p.end));
        EXPECT_EQ(response::broken_rule(q.coefs.data(), d, 10 / layout::kFrictionUnit), nullptr) << coupling;
        for (int k = 0; k < p.friction; ++k) EXPECT_LT(std::abs(q.coefs[std::size_t(k)]), 1 << (bits - 1));
        EXPECT_LT(worst_error(rounded(truth, d, bits, "pair"), scales, samples_of(truth, scales)), error) << bits;
      }
    }
  }
}

TEST(PotentialFit, PathsAreNotRead) {
  const ResponseScales scales{Z, X, kinds[1], 16};
  std::vector<Sample> samples = samples_of(known(kinds[1]), scales, true);
  const VectorXd before = fit_potential(samples, scales, "pair");
  for (Sample& s : samples) {
    if (s.kind == SampleKind::path) s.force *= 2;
  }
  EXPECT_EQ(fit_potential(samples, scales, "pair"), before);
  EXPECT_GT(worst_error(before, scales, samples), 0.4) << "they only test";
}

TEST(PotentialFit, BadSamplesNameThePair) {
  const ResponseScales scales{Z, X, kinds[0], 16};
  std::vector<Sample> samples = samples_of(known(kinds[0]), scales);
  samples[30].force.x() = std::nan("");
  try {
    fit_potential(samples, scales, "pair 17");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::numerical);
    EXPECT_NE(std::string(error.what()).find("pair 17"), std::string::npos);
  }
  EXPECT_THROW(fit_potential({}, scales, "pair"), Error);
}

TEST(PotentialFit, AFrictionlessPairHasNormalForceAndBiasAlone) {
  const ResponseScales scales{Z, 0, {5, 4, 0, 0, false}, 16};
  const VectorXd truth = known(scales.degrees);
  std::vector<Sample> samples;
  const Potential law(truth, scales);
  for (int k = 1; k <= 12; ++k) {
    Sample s;
    s.deflection = {0, 0, Z * k * k / 144};
    s.force = law.force(s.deflection);
    samples.push_back(s);
  }
  const VectorXd coefs = fit_potential(samples, scales, "pair");
  ASSERT_EQ(coefs.size(), 4 + 2 * 3);
  EXPECT_LT(worst_error(coefs, scales, samples), 1e-3);
}

TEST(PotentialDegrees, AreTheFewestThatMeetTheTolerance) {
  const auto choose = [&](const Degrees& truth, double tolerance) {
    const ResponseScales scales{Z, X, truth, 16};
    const std::vector<Sample> samples = samples_of(known(truth), scales);
    return choose_degrees({&samples}, {}, scales, truth.bias > 0, tolerance);
  };
  const DegreeChoice plain = choose({4, 0, 2, 3, true}, 0.01);
  EXPECT_TRUE(plain.met);
  EXPECT_EQ(plain.degrees.stiffness, 2);
  EXPECT_EQ(plain.degrees.bias, 0);
  EXPECT_GT(plain.held_out.samples, 10u);
  const DegreeChoice spring = choose(response::kSpring, 0.01);
  EXPECT_EQ(spring.degrees, response::kSpring);
  EXPECT_LT(spring.held_out.p95, 0.01);
  const ResponseScales scales{Z, X, kinds[0], 16};
  std::vector<Sample> odd = samples_of(known(kinds[0]), scales);
  for (Sample& s : odd) s.force *= 1 + 0.02 * std::sin(37.0 * s.index);
  const DegreeChoice impossible = choose_degrees({&odd}, {}, scales, false, 1e-4);
  EXPECT_FALSE(impossible.met);
  EXPECT_LT(impossible.held_out.p95, 0.1);
  // Normal indentations of other sites need a higher degree than the pair in full.
  const ResponseScales low{Z, X, {4, 0, 2, 3, true}, 16};
  const std::vector<Sample> samples = samples_of(known(low.degrees), low);
  std::vector<Sample> steep;
  double peak = 0;
  for (const Sample& s : samples) peak = std::max(peak, s.force.norm());
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::normal) continue;
    steep.push_back(s);
    steep.back().force.z() += std::pow(s.deflection.z() / Z, 6) * peak;
  }
  const DegreeChoice smooth = choose_degrees({&samples}, {}, low, false, 0.01);
  const DegreeChoice both = choose_degrees({&samples}, {&steep}, low, false, 0.01);
  EXPECT_GT(both.degrees.normal, smooth.degrees.normal);
}

// Too few coefficients miss the shallowest and the deepest sample, which are never left out, by more than those
// between.
TEST(PotentialDegrees, MeetTheToleranceAtBothEndsToo) {
  std::vector<Sample> samples;
  for (int k = 1; k <= 12; ++k) {
    Sample s;
    s.index = static_cast<std::uint16_t>(k - 1);
    const double z = k * k / 144.0;
    s.deflection = {0, 0, Z * z};
    s.force = {0, 0, 0.2 * std::pow(z, 1.6)};
    samples.push_back(s);
  }
  constexpr double kTolerance = 0.02;
  ResponseScales scales{Z, 0, {2, 0, 0, 0, false}, 16};
  const auto figures = [&](int degree) {
    scales.degrees.normal = degree;
    return part_figures({&samples}, scales);
  };
  const DegreeChoice choice = choose_degrees({&samples}, {}, scales, false, kTolerance);
  ASSERT_TRUE(choice.met);
  EXPECT_LT(figures(choice.degrees.normal).fitted.p95, kTolerance);
  const PartFigures fewer = figures(choice.degrees.normal - 1);
  EXPECT_LT(fewer.left_out.p95, kTolerance);
  EXPECT_GT(fewer.fitted.p95, kTolerance);
}

}  // namespace
}  // namespace palpate::fit
