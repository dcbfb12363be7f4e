// SPDX-License-Identifier: GPL-3.0-or-later
// Dense and deterministic: one thread, no time limit.
#include "precompute/fit/least_squares/least_squares.hpp"

#include <ceres/ceres.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "formats/io/error.hpp"

namespace palpate::fit {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstVector = Eigen::Map<const Eigen::VectorXd>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class LinearCost final : public ceres::CostFunction {
public:
  LinearCost(Eigen::MatrixXd matrix, Eigen::VectorXd target) : matrix_(std::move(matrix)), target_(std::move(target)) {
    set_num_residuals(static_cast<int>(matrix_.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(matrix_.cols()));
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const ConstVector x(parameters[0], matrix_.cols());
    Eigen::Map<Eigen::VectorXd>(residuals, matrix_.rows()) = matrix_ * x - target_;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<RowMajor>(jacobians[0], matrix_.rows(), matrix_.cols()) = matrix_;
    }
    return true;
  }

private:
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd target_;
};

class ProductCost final : public ceres::CostFunction {
public:
  explicit ProductCost(const ProductProblem& problem) : problem_(problem) {
    set_num_residuals(static_cast<int>(problem.target.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.a.cols()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.b.cols()));
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::MatrixXd &a = problem_.a, &b = problem_.b;
    const ConstVector x(parameters[0], a.cols()), y(parameters[1], b.cols());
    const Eigen::VectorXd left = problem_.a0 + a * x, right = b * y;
    Eigen::Map<Eigen::VectorXd>(residuals, left.size()) = left.cwiseProduct(right) - problem_.target;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) {
      Eigen::Map<RowMajor>(jacobians[0], a.rows(), a.cols()) = right.asDiagonal() * a;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<RowMajor>(jacobians[1], b.rows(), b.cols()) = left.asDiagonal() * b;
    }
    return true;
  }

private:
  const ProductProblem& problem_;
};

void keep_nonnegative(ceres::Problem& problem, Eigen::VectorXd& block) {
  for (int i = 0; i < block.size(); ++i) problem.SetParameterLowerBound(block.data(), i, 0.0);
}

ceres::Solver::Options solver_options() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-9;
  options.max_solver_time_in_seconds = 1e9;
  return options;
}

void run(ceres::Problem& problem, const std::string& what) {
  ceres::Solver::Options options = solver_options();
  ceres::Solver::Summary summary;
  // Steps along active bounds are short: a few stubborn curves need far more than the default of 50.
  for (const int iterations : {100, 1000, 10000}) {
    options.max_num_iterations = iterations;
    ceres::Solve(options, &problem, &summary);
    if (summary.termination_type == ceres::CONVERGENCE) return;
    if (summary.termination_type != ceres::NO_CONVERGENCE) break;
  }
  throw Error(ExitCode::numerical, what + ": the fit failed: " + summary.message);
}

void check_finite(bool finite, const std::string& what) {
  if (!finite) throw Error(ExitCode::numerical, what + ": a sample is not a finite number");
}

/// Least squares over the columns that are in use; zero elsewhere.
VectorXd solve_columns(const MatrixXd& matrix, const VectorXd& target, const std::vector<bool>& used) {
  std::vector<Eigen::Index> columns;
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (used[k]) columns.push_back(static_cast<Eigen::Index>(k));
  }
  const VectorXd part = MatrixXd(matrix(Eigen::all, columns)).colPivHouseholderQr().solve(target);
  VectorXd x = VectorXd::Zero(matrix.cols());
  x(columns) = part;
  return x;
}

MatrixXd stacked(const MatrixXd& top, const MatrixXd& bottom) {
  MatrixXd result(top.rows() + bottom.rows(), top.cols());
  result << top, bottom;
  return result;
}

VectorXd stacked(const VectorXd& top, const VectorXd& bottom) {
  VectorXd result(top.size() + bottom.size());
  result << top, bottom;
  return result;
}

}  // namespace

VectorXd solve_linear(const MatrixXd& matrix, const VectorXd& target, const std::string& what) {
  check_finite(matrix.allFinite() && target.allFinite(), what);
  return matrix.colPivHouseholderQr().solve(target);
}

VectorXd solve_nonnegative(const MatrixXd& matrix, const VectorXd& target, const std::string& what) {
  check_finite(matrix.allFinite() && target.allFinite(), what);
  const auto n = static_cast<std::size_t>(matrix.cols());
  const double tolerance = 1e-12 * matrix.cwiseAbs().maxCoeff() * std::max(target.norm(), 1e-300);
  std::vector<bool> used(n, false);
  VectorXd x = VectorXd::Zero(matrix.cols());
  for (std::size_t step = 0; step < 100 * n; ++step) {
    // The unused unknown whose growth lowers the residual most; none: done.
    const VectorXd pull = matrix.transpose() * (target - matrix * x);
    std::size_t best = n;
    for (std::size_t k = 0; k < n; ++k) {
      if (!used[k] && pull[k] > tolerance && (best == n || pull[k] > pull[best])) best = k;
    }
    if (best == n) return x;
    used[best] = true;
    VectorXd next = solve_columns(matrix, target, used);
    if (next[best] <= 0) return x;  // nothing but rounding is left to gain
    // Back towards the last x until all are >= 0: what reaches zero first leaves the set.
    for (;;) {
      double share = 1.0;
      std::size_t first = n;
      for (std::size_t k = 0; k < n; ++k) {
        if (!used[k] || next[k] > 0) continue;
        const double until = x[k] > 0 ? x[k] / (x[k] - next[k]) : 0.0;
        if (first == n || until < share) {
          share = until;
          first = k;
        }
      }
      if (first == n) break;
      x += share * (next - x);
      x = x.cwiseMax(0.0);
      x[first] = 0;
      used[first] = false;
      next = solve_columns(matrix, target, used);
    }
    x = next;
  }
  throw Error(ExitCode::numerical, what + ": the non-negative fit did not end");
}

void solve_product(const ProductProblem& product, VectorXd& x, VectorXd& y, const std::string& what) {
  check_finite(product.a.allFinite() && product.b.allFinite() && product.target.allFinite(), what);
  // Each factor alone is a linear problem: a few alternating solves bring Ceres close to the joint minimum.
  const VectorXd y_target = VectorXd::Zero(product.y_rows.rows());
  for (int round = 0; round < 5; ++round) {
    const VectorXd left = product.a0 + product.a * x;
    y = solve_nonnegative(stacked(MatrixXd(left.asDiagonal() * product.b), product.y_rows),
                          stacked(product.target, y_target), what);
    const VectorXd right = product.b * y;
    x = solve_nonnegative(stacked(MatrixXd(right.asDiagonal() * product.a), product.x_rows),
                          stacked(VectorXd(product.target - right.cwiseProduct(product.a0)), product.x_target), what);
  }
  ceres::Problem problem;
  problem.AddResidualBlock(new ProductCost(product), nullptr, x.data(), y.data());
  problem.AddResidualBlock(new LinearCost(product.x_rows, product.x_target), nullptr, x.data());
  problem.AddResidualBlock(new LinearCost(product.y_rows, y_target), nullptr, y.data());
  keep_nonnegative(problem, x);
  keep_nonnegative(problem, y);
  run(problem, what);
}

}  // namespace palpate::fit
