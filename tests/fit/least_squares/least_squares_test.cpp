// SPDX-License-Identifier: GPL-3.0-or-later
// Non-negative least squares: the conditions of a minimum hold on random, degenerate and ill-conditioned problems.
#include "precompute/fit/least_squares/least_squares.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "formats/io/error.hpp"

namespace palpate::fit {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd random_matrix(std::mt19937& random, int rows, int columns) {
  MatrixXd m(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) m(i, j) = static_cast<double>(random()) / 2147483648.0 - 1;
  }
  return m;
}

/// Zero gradient where x > 0, no descent where x = 0.
void expect_minimum(const MatrixXd& a, const VectorXd& b, const VectorXd& x) {
  const VectorXd gradient = a.transpose() * (a * x - b);
  const double small = 1e-9 * a.norm() * b.norm();
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    EXPECT_GE(x[k], 0.0);
    EXPECT_GE(gradient[k], -small);
    if (x[k] > 0) {
      EXPECT_LE(gradient[k], small);
    }
  }
}

TEST(NonNegative, MinimumOfRandomProblems) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 500; ++trial) {
    const int columns = 1 + trial % 10, rows = 1 + trial % 17;
    const MatrixXd a = random_matrix(random, rows, columns);
    const VectorXd b = random_matrix(random, rows, 1);
    expect_minimum(a, b, solve_nonnegative(a, b, "trial"));
  }
}

TEST(NonNegative, IllConditionedColumns) {
  std::mt19937 random(6);
  for (int trial = 0; trial < 200; ++trial) {
    MatrixXd a = random_matrix(random, 12, 8);
    for (int j = 1; j < 8; ++j) a.col(j) = a.col(j - 1) + 1e-4 * a.col(j);
    const VectorXd b = random_matrix(random, 12, 1);
    expect_minimum(a, b, solve_nonnegative(a, b, "trial"));
  }
}

TEST(NonNegative, DegenerateProblemsEnd) {
  const MatrixXd zero = MatrixXd::Zero(3, 2);
  EXPECT_EQ(solve_nonnegative(zero, VectorXd::Ones(3), "zero"), VectorXd::Zero(2));
  MatrixXd twins = MatrixXd::Ones(3, 4);
  const VectorXd x = solve_nonnegative(twins, VectorXd::Ones(3), "twins");
  EXPECT_NEAR(x.sum(), 1.0, 1e-12);
  EXPECT_EQ(solve_nonnegative(twins, -VectorXd::Ones(3), "opposed"), VectorXd::Zero(4));
}

TEST(LeastSquares, NotFiniteIsAnErrorThatNamesThePair) {
  VectorXd b = VectorXd::Ones(3);
  b[1] = std::numeric_limits<double>::quiet_NaN();
  try {
    solve_nonnegative(MatrixXd::Ones(3, 2), b, "pair 3");
    FAIL() << "NaN must not be fitted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::numerical);
    EXPECT_EQ(std::string(error.what()).find("pair 3"), 0U);
  }
  EXPECT_THROW(solve_linear(MatrixXd::Ones(3, 2), b, "pair 3"), Error);
}

TEST(Product, FindsBothFactors) {
  std::mt19937 random(8);
  for (int trial = 0; trial < 20; ++trial) {
    ProductProblem problem;
    problem.a = random_matrix(random, 30, 3).cwiseAbs();
    problem.b = random_matrix(random, 30, 5);
    problem.a0 = VectorXd::Ones(30);
    problem.x_rows = 1e-6 * MatrixXd::Identity(3, 3);
    problem.x_target = VectorXd::Zero(3);
    problem.y_rows = 1e-6 * MatrixXd::Identity(5, 5);
    const VectorXd x = random_matrix(random, 3, 1).cwiseAbs(), y = random_matrix(random, 5, 1).cwiseMax(0.0);
    problem.target = (problem.a0 + problem.a * x).cwiseProduct(problem.b * y);
    VectorXd found_x = VectorXd::Ones(3), found_y;
    solve_product(problem, found_x, found_y, "trial");
    EXPECT_LT((found_y - y).norm(), 1e-3 * (1 + y.norm())) << trial;
    if (y.norm() > 0.1) {
      EXPECT_LT((found_x - x).norm(), 1e-3 * (1 + x.norm())) << trial;
    }
  }
}

}  // namespace
}  // namespace palpate::fit
