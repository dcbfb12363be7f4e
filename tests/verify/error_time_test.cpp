// SPDX-License-Identifier: GPL-3.0-or-later
// Errors against times of solvers whose convergence is known.
#include "precompute/verify/error_time.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace palpate::verify {
namespace {

// Values 2 and 5 plus `error` of them at size 1, of this order; a time of `seconds` / size^3.
SizeStudy study(double error, double order, double seconds) {
  SizeStudy s;
  for (const double h : {2.0, 1.0, 0.5, 0.25}) {
    const double factor = 1 + error * std::pow(h, order);
    s.sizes.push_back(h);
    s.values.push_back({2 * factor, 5 * factor});
    s.seconds.push_back(seconds / (h * h * h));
  }
  return s;
}

TEST(ErrorTime, LimitOrderAndErrorsOfAPowerLaw) {
  const ErrorTime e = error_against_time(study(0.01, 1.5, 1));
  EXPECT_TRUE(e.observed);
  EXPECT_NEAR(e.order, 1.5, 0.01);
  EXPECT_NEAR(e.limit[0], 2, 1e-4);
  EXPECT_NEAR(e.limit[1], 5, 2e-4);
  EXPECT_NEAR(e.errors[1], 0.01, 1e-4);
}

TEST(ErrorTime, OrderThatCannotBeIsNotBelieved) {
  SizeStudy s = study(0.01, 1.5, 1);
  s.values = {{1.0}, {1.001}, {1.002}, {1.004}};  // it moves away
  const ErrorTime e = error_against_time(s);
  EXPECT_FALSE(e.observed);
  EXPECT_EQ(e.order, 2);
  EXPECT_NEAR(e.limit[0], 1.004 + 0.002 / 3, 1e-12);
}

TEST(ErrorTime, RatioAtEqualError) {
  // Errors 0.01 h^2 in h^-3 s against 0.04 h^2 in 10 h^-3 s: at equal error h is half, so the time 80 times.
  const ErrorTime ours = error_against_time(study(0.01, 2, 1));
  ErrorTime other = error_against_time(study(0.04, 2, 10));
  const auto ratios = time_ratios(ours, other);
  ASSERT_EQ(ratios.size(), 3U);
  for (const TimeRatio& r : ratios) EXPECT_NEAR(r.other / r.ours, 80, 2) << r.error;
  EXPECT_NEAR(ratios[0].error, 0.0025, 1e-4);
  EXPECT_NEAR(ratios[2].error, 0.04, 1e-3);
  EXPECT_NEAR(ratios[1].error, 0.01, 1e-3);
  // Sizes without a time take no part.
  other.seconds[3] = 0;
  EXPECT_NEAR(time_ratios(ours, other)[0].error, 0.01, 1e-3);
  // No error in common: nothing is said.
  EXPECT_TRUE(time_ratios(ours, error_against_time(study(10, 2, 1))).empty());
}

TEST(ErrorTime, SizesMustFallByOneFactor) {
  SizeStudy s = study(0.01, 2, 1);
  s.sizes[1] = 1.2;
  EXPECT_THROW(error_against_time(s), std::invalid_argument);
  s = study(0.01, 2, 1);
  for (auto* part : {&s.sizes, &s.seconds}) part->resize(2);
  s.values.resize(2);
  EXPECT_THROW(error_against_time(s), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::verify
