// SPDX-License-Identifier: GPL-3.0-or-later
// Sparse Cholesky factor of a symmetric positive definite matrix: made by CHOLMOD in double precision, applied in
// single.
#pragma once

#include <Eigen/SparseCore>
#include <memory>

namespace palpate {

class Factor {
public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// Orders and analyses the pattern of `lower`, the lower triangle.
  explicit Factor(const Matrix& lower);
  ~Factor();
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;

  /// `lower` has the pattern of the constructor's. False where it is not positive definite.
  bool factorise(const Matrix& lower);

  /// x with A x = b to double precision. Needs a factor.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// The same by a copy of the factor in single precision: half the bytes have to be read. As a preconditioner it is as
  /// good as the other while `single_error` is small.
  [[nodiscard]] Eigen::VectorXd solve_single(const Eigen::VectorXd& b) const;
  /// Of a solve for this b in single precision: length of the error over that of the solution.
  [[nodiscard]] double single_error(const Eigen::VectorXd& b) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
