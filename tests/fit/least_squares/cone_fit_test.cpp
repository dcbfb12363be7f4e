// SPDX-License-Identifier: GPL-3.0-or-later
// Least squares over cones: minima that are known, and what no point inside the cones improves.
#include "precompute/fit/least_squares/cone_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "formats/io/error.hpp"
#include "precompute/fit/least_squares/least_squares.hpp"

namespace palpate::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<Cone> half_lines(Index n) {
  std::vector<Cone> cones;
  for (Index k = 0; k < n; ++k) cones.push_back({{k}, MatrixXd::Ones(1, 1)});
  return cones;
}

TEST(ConeFit, TheNearestPointOfACone) {
  const std::vector<Cone> cone{{{0, 1, 2}, MatrixXd::Identity(3, 3)}};
  const Eigen::Vector3d from(0.5, 3, -4);  // outside: goes to the surface along ((|v| + y0) / 2) (1, v / |v|)
  const VectorXd x = solve_in_cones(MatrixXd::Identity(3, 3), from, cone, Eigen::Vector3d(1, 0, 0), "pair");
  EXPECT_LT((x - 2.75 * Eigen::Vector3d(1, 0.6, -0.8)).norm(), 1e-5);
}

TEST(ConeFit, WithHalfLinesItIsTheNonNegativeFit) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 20; ++trial) {
    const MatrixXd a = MatrixXd::NullaryExpr(30, 8, [&] { return normal(random); });
    const VectorXd b = VectorXd::NullaryExpr(30, [&] { return normal(random); });
    const VectorXd x = solve_in_cones(a, b, half_lines(8), VectorXd::Ones(8), "pair");
    EXPECT_LE((a * x - b).squaredNorm(), (a * solve_nonnegative(a, b, "pair") - b).squaredNorm() * (1 + 2e-6));
    EXPECT_GE(x.minCoeff(), 0);
  }
}

// A start next to the tip, a target far away, and columns of sizes that are thousands of millions apart.
TEST(ConeFit, HardStartsAndScalesComeToTheSameMinimum) {
  MatrixXd a = MatrixXd::Identity(4, 3);
  a.row(3) << 1, 1, 1;
  a.col(2) *= 1e-5;
  a *= 300;
  const Eigen::Vector4d b(-200, 500, 40, 100);
  const std::vector<Cone> cones{{{0, 1}, MatrixXd::Identity(2, 2)}, {{0, 2}, Eigen::RowVector2d(1, -1)}};
  const VectorXd x = solve_in_cones(a, b, cones, Eigen::Vector3d(1e-6, 0, -1e-6), "pair");
  const VectorXd y = solve_in_cones(a, b, cones, Eigen::Vector3d(1e3, 5, 3), "pair");
  const double least = (a * y - b).squaredNorm();
  EXPECT_NEAR((a * x - b).squaredNorm(), least, 2e-6 * least);
  EXPECT_GE(x[0], std::abs(x[1]));
}

TEST(ConeFit, RefusesByName) {
  const auto refusal = [](const VectorXd& target, const VectorXd& start) -> std::string {
    try {
      solve_in_cones(MatrixXd::Identity(2, 2), target, half_lines(2), start, "pair 7");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::numerical);
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(Eigen::Vector2d(1, 1), Eigen::Vector2d(1, 1)), "");
  EXPECT_EQ(refusal(Eigen::Vector2d(1, 1), Eigen::Vector2d(1, 0)), "pair 7: no start inside the constraints");
  EXPECT_EQ(refusal(Eigen::Vector2d(NAN, 1), Eigen::Vector2d(1, 1)), "pair 7: a sample is not a finite number");
}

}  // namespace
}  // namespace palpate::fit
