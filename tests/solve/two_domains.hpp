// SPDX-License-Identifier: GPL-3.0-or-later
// A law of an endless body on two that end: the body's share of the error goes with 1 / size, so that two sizes say how
// large it is, and what is left of the error without any.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace palpate::test {

/// What solves on bodies of two sizes give over the law, value by value, and what both say of an endless body.
struct TwoDomains {
  std::vector<double> small, large, endless;
};

/// `over_law(size)` gives the values; what failed has said so and gives none.
template <class OverLaw>
TwoDomains on_two_domains(double small, double large, const OverLaw& over_law) {
  TwoDomains two{over_law(small), over_law(large), {}};
  EXPECT_FALSE(two.large.empty());
  EXPECT_EQ(two.small.size(), two.large.size());
  if (two.small.size() != two.large.size()) return {};
  for (std::size_t k = 0; k < two.large.size(); ++k) {
    two.endless.push_back((large * two.large[k] - small * two.small[k]) / (large - small));
  }
  return two;
}

/// Value `k` on the larger and on the endless body is within `tolerance` of the law, and the sizes differ by no more.
inline void expect_law(const TwoDomains& two, std::size_t k, double tolerance) {
  EXPECT_NEAR(two.large.at(k), 1, tolerance) << k;
  EXPECT_NEAR(two.small.at(k), two.large.at(k), tolerance) << k;
  EXPECT_NEAR(two.endless.at(k), 1, tolerance) << k;
}

inline void expect_law(const TwoDomains& two, double tolerance) {
  for (std::size_t k = 0; k < two.endless.size(); ++k) expect_law(two, k, tolerance);
}

}  // namespace palpate::test
