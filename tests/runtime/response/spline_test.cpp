// SPDX-License-Identifier: GPL-3.0-or-later
// The spline basis of bonded curves against its definition: partition of unity, powers, slopes.
#include "palpate/format/spline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace palpate::spline_test {
namespace {

// Cox and de Boor's definition with its divisions, on knots 0,0,0,0,1,...,m,m,m,m.
double definition(int count, int i, int degree, double t) {
  const auto knot = [count](int k) { return static_cast<double>(std::clamp(k - 3, 0, count - 3)); };
  if (degree == 0) {
    const bool last = t >= count - 3 && knot(i) < knot(i + 1) && knot(i + 1) >= count - 3;
    return (knot(i) <= t && t < knot(i + 1)) || last ? 1.0 : 0.0;
  }
  double sum = 0;
  const double left = knot(i + degree) - knot(i), right = knot(i + degree + 1) - knot(i + 1);
  if (left > 0) sum += (t - knot(i)) / left * definition(count, i, degree - 1, t);
  if (right > 0) sum += (knot(i + degree + 1) - t) / right * definition(count, i + 1, degree - 1, t);
  return sum;
}

TEST(Spline, WeightsAreThoseOfTheDefinitionForEveryCount) {
  for (int count = 4; count <= 32; ++count) {
    for (int k = 0; k <= 60; ++k) {
      const double u = k / 60.0;
      const spline::Basis b = spline::basis(count, u);
      ASSERT_GE(b.first, 0);
      ASSERT_LE(b.first + 3, count - 1);
      double sum = 0;
      for (int j = 0; j < 4; ++j) {
        sum += b.weight[j];
        ASSERT_NEAR(b.weight[j], definition(count, b.first + j, 3, u * (count - 3)), 1e-12) << count << " " << u;
      }
      ASSERT_NEAR(sum, 1, 1e-14);
    }
  }
}

TEST(Spline, SlopeIsThatOfFiniteDifferences) {
  for (const int count : {4, 5, 10, 32}) {
    std::vector<double> c;
    for (int i = 0; i < count; ++i) c.push_back(std::sin(1.7 * i));
    const auto value = [&](double u) { return spline::value(c.data(), count, u); };
    for (int k = 1; k < 50; ++k) {
      const double u = k / 50.0, h = 1e-6;
      EXPECT_NEAR(spline::combine(spline::slope_basis(count, u), c.data()), (value(u + h) - value(u - h)) / (2 * h), 1e-3);
    }
    EXPECT_NEAR(spline::combine(spline::slope_basis(count, 0), c.data()), 3 * (count - 3) * (c[1] - c[0]), 1e-9);
  }
}

TEST(Spline, GrevilleAbscissaeReproduceTheIdentity) {
  std::vector<double> c;
  for (int i = 0; i < 9; ++i) c.push_back(spline::greville(9, i));
  for (int k = 0; k <= 50; ++k) EXPECT_NEAR(spline::value(c.data(), 9, k / 50.0), k / 50.0, 1e-14);
}

TEST(Spline, AbscissaIsClampedAndNanIsZero) {
  const std::vector<double> c = {1, 2, 3, 4, 5};
  EXPECT_EQ(spline::value(c.data(), 5, -3), 1);
  EXPECT_EQ(spline::value(c.data(), 5, 7), 5);
  EXPECT_EQ(spline::value(c.data(), 5, std::numeric_limits<double>::quiet_NaN()), 1);
}

}  // namespace
}  // namespace palpate::spline_test
