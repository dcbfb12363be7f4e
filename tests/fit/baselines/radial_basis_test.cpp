// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/baselines/radial_basis.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "formats/io/error.hpp"
#include "tests/fit/analytic_pair.hpp"

namespace palpate::fit::radial_basis_test {
namespace {

constexpr double kDepth = 0.004, kReach = 0.0016;

std::vector<Sample> samples() {
  test::AnalyticPair pair = test::power_law(2000, 1.5);
  pair.friction = 0.3;
  pair.growth = [](double z) { return std::sqrt(z / kDepth); };
  pair.tangential_x = pair.tangential_y = [](double x) { return -300 * x; };
  return test::samples_of(pair, kDepth, 12, 3, 8, kReach / kDepth);
}

double worst(const verify::RadialBasis& network, const std::vector<Sample>& all) {
  const double peak = all[11].force.norm();
  double most = 0;
  for (const Sample& s : all) {
    most = std::max(most, (network.force(s.deflection) - s.force).norm() / std::max(s.force.norm(), 0.02 * peak));
  }
  return most;
}

TEST(RadialBasis, GoesThroughItsSamplesWithACentreAtEach) {
  const std::vector<Sample> all = samples();
  const auto fitted = [&](int centres) { return verify::fit_radial_basis(all, kDepth, kReach, centres, "test"); };
  EXPECT_LT(worst(fitted(1000), all), 0.01);
  EXPECT_EQ(fitted(1000).centres.rows(), static_cast<Eigen::Index>(all.size()));
  EXPECT_LT(worst(fitted(24), all), 0.5 * worst(fitted(6), all));
  EXPECT_EQ(fitted(24).force({0, 0, 0}), Eigen::Vector3d::Zero());
  EXPECT_EQ(verify::RadialBasis::bytes(24), 576);
  EXPECT_THROW(verify::fit_radial_basis({all[0]}, kDepth, kReach, 6, "test"), Error) << "one normal indentation";
}

}  // namespace
}  // namespace palpate::fit::radial_basis_test
