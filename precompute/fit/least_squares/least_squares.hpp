// SPDX-License-Identifier: GPL-3.0-or-later
// Small least-squares problems: a linear one, the same with x >= 0, and a product of two linear factors (Ceres).
#pragma once

#include <Eigen/Core>
#include <string>

namespace palpate::fit {

/// Minimises |matrix x - target|^2. Throws Error(numerical) "what: ..." when an entry is not finite.
Eigen::VectorXd solve_linear(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& target, const std::string& what);

/// The same with x >= 0 (Lawson and Hanson's active set: exact, in finitely many steps). Throws as solve_linear, and
/// when the steps do not end.
Eigen::VectorXd solve_nonnegative(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& target,
                                  const std::string& what);

/// Residuals (a0 + a x)_i (b y)_i - target_i, and two linear priors x_rows x - x_target, y_rows y; x, y >= 0.
struct ProductProblem {
  Eigen::MatrixXd a, b;
  Eigen::VectorXd a0, target;
  Eigen::MatrixXd x_rows, y_rows;
  Eigen::VectorXd x_target;
};

/// Minimises the problem's residuals jointly over x and y, starting from x. Throws Error(numerical) "what: ..." when
/// an entry is not finite or Ceres does not converge.
void solve_product(const ProductProblem& problem, Eigen::VectorXd& x, Eigen::VectorXd& y, const std::string& what);

}  // namespace palpate::fit
