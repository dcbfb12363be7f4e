// SPDX-License-Identifier: GPL-3.0-or-later
// Rows against direct solutions: elimination, enumeration of active sets, many sweeps; and at extremes.
#include "palpate/mechanism/rows.hpp"

#include "tests/runtime/allocation_counter.hpp"
#include "tools/bench/plate_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <vector>

namespace palpate::rows_test {
namespace {

using cli::Plate;
using runtime::Rows;
using runtime::RowsOutcome;
using Matrix = std::vector<std::vector<double>>;
using Vector = std::vector<double>;

constexpr int kMany = 20000;  // sweeps: to rounding

// A random symmetric positive matrix.
Matrix positive(int size, std::mt19937& random) {
  std::normal_distribution<double> draw;
  const auto n = static_cast<std::size_t>(size);
  Matrix factor(n, Vector(n)), product(n, Vector(n));
  for (Vector& row : factor) {
    for (double& value : row) value = draw(random);
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t k = 0; k < n; ++k) product[i][j] += factor[i][k] * factor[j][k];
    }
    product[i][i] += 0.1;
  }
  return product;
}

// x with a x = b, by elimination with pivots.
Vector solution(Matrix a, Vector b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t most = k;
    for (std::size_t i = k; i < n; ++i) most = std::fabs(a[i][k]) > std::fabs(a[most][k]) ? i : most;
    std::swap(a[k], a[most]);
    std::swap(b[k], b[most]);
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n; ++j) a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = 0; k < n; ++k) b[k] /= a[k][k];
  return b;
}

template <int Most>
void fill(Rows<Most>& rows, const Matrix& w) {
  for (int i = 0; i < rows.size(); ++i) {
    for (int j = 0; j <= i; ++j) {
      rows.add_compliance(i, j, w[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]);
    }
  }
  ASSERT_EQ(rows.prepare(), nullptr);
}

TEST(Rows, BilateralRowsAreSolvedExactlyByOneSweep) {
  std::mt19937 random(1);
  std::normal_distribution<double> draw;
  for (int size = 1; size <= 13; ++size) {
    Rows<13> rows;
    for (int k = 0; k < size; ++k) EXPECT_EQ(rows.add_bilateral(), k);
    const Matrix w = positive(size, random);
    fill(rows, w);
    Vector free(static_cast<std::size_t>(size)), force(free.size(), 0.0), right;
    for (double& f : free) f = draw(random), right.push_back(-f);
    EXPECT_TRUE(rows.solve(free.data(), force.data(), 1).converged());
    const Vector expected = solution(w, right);
    for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(force[k], expected[k], 1e-8);
  }
}

// Two bilateral and four unilateral rows: one of the sixteen sets of pressing rows has no pull and no negative gap.
TEST(Rows, UnilateralRowsHaveTheForcesOfTheOnlyConsistentSet) {
  std::mt19937 random(2);
  std::normal_distribution<double> draw;
  for (int trial = 0; trial < 50; ++trial) {
    Rows<6> rows;
    for (int k = 0; k < 2; ++k) rows.add_bilateral();
    for (int k = 0; k < 4; ++k) rows.add_limited(0, HUGE_VAL);
    const Matrix w = positive(6, random);
    fill(rows, w);
    Vector free(6), force(6, 0.0);
    for (double& f : free) f = draw(random);
    rows.solve(free.data(), force.data(), kMany);
    int consistent = 0;
    for (unsigned set = 0; set < 16; ++set) {
      std::vector<std::size_t> held{0, 1};
      for (std::size_t k = 0; k < 4; ++k) {
        if ((set >> k & 1U) != 0) held.push_back(2 + k);
      }
      Matrix part(held.size(), Vector(held.size()));
      Vector right;
      for (std::size_t i = 0; i < held.size(); ++i) {
        for (std::size_t j = 0; j < held.size(); ++j) part[i][j] = w[held[i]][held[j]];
        right.push_back(-free[held[i]]);
      }
      const Vector some = solution(part, right);
      Vector all(6, 0.0);
      for (std::size_t i = 0; i < held.size(); ++i) all[held[i]] = some[i];
      bool good = true;
      for (std::size_t k = 2; k < 6; ++k) {
        double gap = free[k];
        for (std::size_t j = 0; j < 6; ++j) gap += w[k][j] * all[j];
        good = good && all[k] >= 0 && gap >= -1e-9;
      }
      if (!good) continue;
      ++consistent;
      for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(force[k], all[k], 1e-6);
    }
    EXPECT_EQ(consistent, 1);
  }
}

TEST(Rows, LimitedRowIsClampedToItsRange) {
  Rows<1> rows;
  rows.add_limited(-0.3, 0.5);
  rows.add_compliance(0, 0, 2.0);
  ASSERT_EQ(rows.prepare(), nullptr);
  for (const double free : {-3.0, -0.4, 0.0, 0.4, 3.0}) {
    double force = 0;
    rows.solve(&free, &force, 3);
    const double expected = std::clamp(-free / 2, -0.3, 0.5);
    EXPECT_DOUBLE_EQ(force, expected);
    EXPECT_NEAR(rows.gap(0), free + 2 * expected, 1e-15);
  }
}

TEST(Rows, SlipOpposesTheFrictionWhateverTheCompliance) {
  std::mt19937 random(3);
  std::normal_distribution<double> draw;
  for (int trial = 0; trial < 100; ++trial) {
    Rows<3> rows;
    const double mu = 0.4;
    ASSERT_EQ(rows.add_contact(mu), 0);
    fill(rows, positive(3, random));
    const double free[3] = {-1 - std::fabs(draw(random)), 3 * draw(random), 3 * draw(random)};
    double force[3] = {};
    rows.solve(free, force, kMany);
    const double limit = mu * force[0], size = std::hypot(force[1], force[2]);
    const double slip = std::hypot(rows.gap(1), rows.gap(2));
    EXPECT_LE(size, limit * (1 + 1e-12));
    if (size < limit * (1 - 1e-9)) {
      EXPECT_LT(slip, 1e-8);
    } else {
      EXPECT_NEAR(force[1] * rows.gap(1) + force[2] * rows.gap(2), -size * slip, 1e-6 * (1 + size * slip));
    }
  }
}

TEST(Rows, A120RowsReachATenthOfAPercentIn16Sweeps) {
  for (const double spring : {50.0, 500.0, 5000.0}) {
    Plate plate;
    plate.spring = spring;
    const auto rows = std::make_unique<Plate::Rows>();
    ASSERT_EQ(plate.fill(*rows), nullptr);
    const Plate::Values before = Plate::converged(*rows, plate.gaps(2.9e-3, 0.9e-3));
    const Plate::Values gaps = plate.gaps(3e-3, 1e-3);  // 0.1 mm on: 0.1 m/s at 1 kHz
    const Plate::Values exact = Plate::converged(*rows, gaps);
    Plate::Values now = before;
    rows->solve(gaps.data(), now.data(), 16);
    EXPECT_LT(Plate::difference(now, exact), 1e-3) << spring;
    EXPECT_GT(Plate::difference(before, exact), 1e-2) << "the step changes the force";
  }
}

TEST(Rows, SameInputHasTheSameBits) {
  const Plate plate;
  const auto rows = std::make_unique<Plate::Rows>(), again = std::make_unique<Plate::Rows>();
  ASSERT_EQ(plate.fill(*rows), nullptr);
  ASSERT_EQ(plate.fill(*again), nullptr);
  Plate::Values a{}, b{};
  for (int k = 0; k < 50; ++k) {
    const Plate::Values gaps = plate.gaps(1e-4 * k, 2e-5 * k);
    rows->solve(gaps.data(), a.data(), 5);
    again->solve(gaps.data(), b.data(), 5);
  }
  EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof a), 0);
}

// Moduli and springs over nine and six decades, places far apart, at one place, and gaps of a nanometre.
TEST(Rows, StiffCellsConvergeOrAreReported) {
  int converged = 0, cells = 0;
  for (const double young : {1.0, 1e3, 1e6, 1e9}) {
    for (const double spring : {1.0, 1e3, 1e6}) {
      for (const double spacing : {3.5e-3, 1e-6, 0.0}) {
        for (const double scale : {1.0, 1e-6}) {
          Plate plate;
          plate.young = young;
          plate.spring = spring;
          plate.spacing = spacing;
          const auto rows = std::make_unique<Plate::Rows>();
          if (plate.fill(*rows) != nullptr) continue;
          const Plate::Values gaps = plate.gaps(3e-3 * scale, 1e-3 * scale);
          const Plate::Values exact = Plate::converged(*rows, gaps);
          for (const int sweeps : {2, 8, 64}) {
            Plate::Values force{};
            const RowsOutcome outcome = rows->solve(gaps.data(), force.data(), sweeps);
            for (const double f : force) ASSERT_TRUE(std::isfinite(f)) << young << ' ' << spring << ' ' << spacing;
            ++cells;
            if (!outcome.converged()) continue;
            ++converged;
            EXPECT_LT(Plate::difference(force, exact), 1e-2)
                << "E " << young << ", spring " << spring << ", spacing " << spacing << ", gaps " << scale << ", "
                << sweeps << " sweeps, estimate " << outcome.error;
          }
        }
      }
    }
  }
  EXPECT_GT(converged, cells / 2);
}

TEST(Rows, RepeatedBilateralRowHasNoForceAndAConflictIsReported) {
  for (const double conflict : {0.0, 1e-3}) {
    Rows<3> rows;
    for (int k = 0; k < 2; ++k) rows.add_bilateral();
    rows.add_limited(0, HUGE_VAL);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) rows.add_compliance(i, j, 1e-3);  // all hold one point of one spring
    }
    ASSERT_EQ(rows.prepare(), nullptr);
    const double free[3] = {-1e-3, -1e-3 - conflict, 1e-3};
    double force[3] = {};
    const RowsOutcome outcome = rows.solve(free, force, 4);
    EXPECT_TRUE(rows.dependent(1));
    EXPECT_DOUBLE_EQ(force[0], 1);
    EXPECT_EQ(force[1], 0);
    EXPECT_EQ(force[2], 0);
    EXPECT_EQ(outcome.converged(), conflict == 0);
  }
}

TEST(Rows, RowsWithoutRoomOrOrderAreRefused) {
  Rows<4> rows;
  EXPECT_EQ(rows.add_bilateral(), 0);
  EXPECT_EQ(rows.add_contact(0.3), 1);
  EXPECT_EQ(rows.add_bilateral(), -1);
  EXPECT_EQ(rows.add_limited(0, 1), -1);
  EXPECT_EQ(rows.add_contact(0.3), -1);
  EXPECT_NE(rows.prepare(), nullptr) << "no row has a compliance";
}

TEST(Rows, ValuesThatAreNotFiniteGiveNoForce) {
  Rows<2> rows;
  for (int k = 0; k < 2; ++k) rows.add_limited(0, HUGE_VAL);
  for (int k = 0; k < 2; ++k) rows.add_compliance(k, k, 1);
  ASSERT_EQ(rows.prepare(), nullptr);
  for (const double bad : {HUGE_VAL, std::numeric_limits<double>::quiet_NaN()}) {
    const double free[2] = {-1, bad};
    double force[2] = {1, 1};
    const RowsOutcome outcome = rows.solve(free, force, 4);
    EXPECT_FALSE(outcome.finite);
    EXPECT_FALSE(outcome.converged());
    EXPECT_EQ(force[0], 0);
  }
  rows.add_compliance(0, 1, std::numeric_limits<double>::quiet_NaN());
  EXPECT_NE(rows.prepare(), nullptr);
  const double free[2] = {-1, -1};
  double force[2] = {};
  EXPECT_FALSE(rows.solve(free, force, 4).finite);
}

TEST(Rows, NoSolveAllocates) {
  const Plate plate;
  const auto rows = std::make_unique<Plate::Rows>();
  ASSERT_EQ(plate.fill(*rows), nullptr);
  Plate::Values force{};
  const Plate::Values gaps = plate.gaps(3e-3, 1e-3);
  const long before = test::allocations();
  rows->prepare();
  rows->solve(gaps.data(), force.data(), 8);
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace palpate::rows_test
