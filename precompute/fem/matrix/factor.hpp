// SPDX-License-Identifier: GPL-3.0-or-later
// Sparse Cholesky factor of a symmetric positive definite matrix: in single precision where that is good enough for a
// preconditioner, else CHOLMOD's in double.
#pragma once

#include <Eigen/SparseCore>
#include <limits>
#include <memory>

namespace palpate::fem {

class Factor {
public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// Orders and analyses the pattern of `lower`, the lower triangle. Throws Error(numerical) where a factor of it, in
  /// single and in double precision together, takes more than `most_bytes`.
  explicit Factor(const Matrix& lower, double most_bytes = std::numeric_limits<double>::infinity());
  ~Factor();
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;

  /// `lower` has the pattern of the constructor's. False where it is not positive definite. `load` is a right-hand side
  /// of the kind to come: a factor in single precision stays only where it solves for that one within 2 %.
  bool factorise(const Matrix& lower, const Eigen::VectorXd& load);
  /// The same in double precision, for solves that nothing refines.
  bool factorise_double(const Matrix& lower);
  /// Whether the factor is in single precision.
  [[nodiscard]] bool single() const;

  /// x with A x = b. Needs a factor.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// The same of several right-hand sides at once. Needs factorise_double().
  [[nodiscard]] Eigen::MatrixXd solve_all(const Eigen::MatrixXd& b) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::fem
