// SPDX-License-Identifier: GPL-3.0-or-later
// The spline basis against its definition: partition of unity, reproduction of cubics, slopes.
#include "palpate/spline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "palpate/pieces.hpp"

#include "tests/support/response_samples.hpp"

namespace palpate {
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

TEST(Spline, MatchesTheDefinitionForEveryCount) {
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

TEST(Spline, ReproducesPowersAndTheirSlopes) {
  for (const int count : {4, 5, 10, 32}) {
    for (int power = 1; power <= 3; ++power) {
      const std::vector<float> c = test::sample_detail::monomial(count, power, 1);
      for (int k = 0; k <= 50; ++k) {
        const double u = k / 50.0;
        EXPECT_NEAR(spline::value(c.data(), count, u), std::pow(u, power), 2e-7);
        EXPECT_NEAR(spline::combine(spline::slope_basis(count, u), c.data()), power * std::pow(u, power - 1), 1e-4);
      }
      EXPECT_NEAR(spline::combine(spline::slope_basis(count, 0), c.data()), power == 1 ? 1 : 0, 1e-5);
      EXPECT_NEAR(spline::combine(spline::slope_basis(count, 1), c.data()), power, 1e-4);
    }
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

// Against Simpson's rule, which is exact for t f(t) on each half interval but for its fourth power.
TEST(Spline, FirstMomentIsTheIntegral) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int count = 4; count <= 12; ++count) {
    std::vector<double> c;
    for (int i = 0; i < count; ++i) c.push_back(unit(random));
    const auto integrand = [&](double t) { return t * spline::value(c.data(), count, t / (count - 3)); };
    double sum = 0;
    constexpr int kParts = 400;
    for (int part = 0; part < kParts * (count - 3); ++part) {
      const double low = part / double{kParts}, high = (part + 1) / double{kParts};
      sum += (integrand(low) + 4 * integrand(0.5 * (low + high)) + integrand(high)) / (6 * kParts);
      if (part % 97 != 0) continue;
      const int interval = spline::interval_of(count, high);
      const double whole =
          spline::first_moment(c.data(), count, interval) +
          spline::first_moment(spline::Interval(count, interval).cubic(c.data()), interval, high - interval);
      ASSERT_NEAR(whole, sum, 1e-10) << count << ' ' << high;
    }
  }
}

template <int N>
bool values(const runtime::Pieces<N>& pieces, const runtime::Lanes<N>& t, runtime::Lanes<N>& value) {
  runtime::Lanes<N> share;
  const bool inside = pieces.shares(t, share);
  pieces.at(share, value);
  return inside;
}

// Two curves at once, each asked at its own abscissa, which jumps, creeps, and trembles about a knot.
TEST(Pieces, AreTheSplinesWhateverWasAskedBefore) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int count = 4; count <= 32; ++count) {
    std::vector<float> c;
    for (int i = 0; i < 2 * count; ++i) c.push_back(static_cast<float>(unit(random) - 0.5));
    runtime::Pieces<2> pieces;
    pieces.forget();
    double u[2] = {0, 1};
    int taken = 0;
    for (int step = 0; step < 1000; ++step) {
      for (double& at : u) {
        const double knot = std::round(at * (count - 3)) / (count - 3);
        if (step % 7 == 0) at = unit(random);
        if (step % 7 == 1) at = knot;
        if (step % 7 == 2) at += 1e-3 * (unit(random) - 0.5);
        if (step % 7 > 2) at = knot + 1e-7 * (unit(random) - 0.5);
        at = std::clamp(at, 0.0, 1.0);
      }
      const runtime::Lanes<2> t{{runtime::two(spline::in_intervals(count, u[0]), spline::in_intervals(count, u[1]))}};
      runtime::Lanes<2> value;
      if (!values(pieces, t, value)) {
        for (int k = 0; k < 2; ++k) {
          const int interval = spline::interval_onwards(count, t[k]);
          pieces.take(k, c.data() + k * count, {count, interval}, interval);
        }
        ASSERT_TRUE(values(pieces, t, value));
        ++taken;
      }
      for (int k = 0; k < 2; ++k) {
        ASSERT_NEAR(value[k], spline::value(c.data() + k * count, count, u[k]), 1e-14) << count << " " << u[k];
      }
    }
    EXPECT_LT(taken, 600) << "it remembers";
  }
}

TEST(Spline, GoesOnAlongItsTangents) {
  const double c[] = {1, 2, -1, 4, 3, 7};
  constexpr int kCount = 6;
  const double first = 3 * (c[1] - c[0]), last = 3 * (c[5] - c[4]);  // by interval
  const auto at = [&](double t) {
    const int interval = spline::interval_onwards(kCount, t);
    return spline::value(spline::Interval(kCount, interval).cubic(c), t - interval);
  };
  for (const double t : {0.0, 0.4, 1.0, 2.9, 3.0}) EXPECT_NEAR(at(t), spline::value(c, kCount, t / 3), 1e-14) << t;
  for (const double further : {1e-9, 0.3, 1.0, 5.0}) {
    EXPECT_NEAR(at(-further), c[0] - further * first, 1e-14);
    EXPECT_NEAR(at(3 + further), c[5] + further * last, 1e-13);
    EXPECT_NEAR(spline::combine(spline::basis_onwards(kCount, 1 + further / 3), c), c[5] + further * last, 1e-13);
  }
  EXPECT_EQ(spline::interval_onwards(kCount, std::numeric_limits<double>::quiet_NaN()), -1);
  EXPECT_EQ(spline::interval_onwards(kCount, 1e300), 3);
}

// However their cubics are made: one curve's, two at once, beyond the ends, too.
TEST(Pieces, TakeTheSameCubicsOneByOneAndInTwos) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int count = 4; count <= 32; ++count) {
    std::vector<float> c[2];
    for (auto& curve : c) {
      for (int i = 0; i < count; ++i) curve.push_back(unit(random));
    }
    for (int interval = -1; interval <= count - 3; ++interval) {
      const spline::Interval at(count, interval);
      runtime::Pieces<2> alone, both;
      both.take_two(0, c[0].data() + at.first(), c[1].data() + at.first(), at, interval);
      for (int k = 0; k < 2; ++k) {
        alone.take(k, c[k].data(), at, interval);
        for (const auto* pieces : {&alone, &both}) {
          EXPECT_EQ(pieces->interval(k), interval);
          const spline::Cubic cubic = pieces->cubic(k), want = at.cubic(c[k].data());
          for (int p = 0; p < 4; ++p) EXPECT_NEAR(cubic.power[p], want.power[p], 1e-15) << count << ' ' << interval;
        }
      }
    }
  }
}

TEST(Pieces, ForgetOldCoefficients) {
  const std::vector<float> first = {1, 1, 1, 1, 1}, second = {2, 2, 2, 2, 2};
  runtime::Pieces<1> piece;
  const auto at = [](double t) { return runtime::Lanes<1>{{runtime::two(t, 0)}}; };
  runtime::Lanes<1> value;
  for (const std::vector<float>* coefs : {&first, &second}) {
    piece.forget();
    EXPECT_FALSE(values(piece, at(0.5), value));
    piece.take(0, coefs->data(), {5, 0}, 0);
    piece.known_values(at(0.5), value);
    EXPECT_NEAR(value[0], (*coefs)[0], 1e-15);
  }
  EXPECT_FALSE(values(piece, at(1.5), value));
  EXPECT_FALSE(values(piece, at(std::numeric_limits<double>::quiet_NaN()), value));
}

}  // namespace
}  // namespace palpate
