// SPDX-License-Identifier: GPL-3.0-or-later
// Sparse Cholesky factor in single precision, as a preconditioner: half the bytes and half the time of one in double.
#pragma once

#include "precompute/fem/matrix/supernode.hpp"

#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

namespace palpate::fem {

/// Result of a symbolic analysis: supernodes of neighbouring columns with the same rows, in the order of elimination.
struct SupernodalPattern {
  std::vector<int> order;   ///< original index of each row and column
  std::vector<int> first;   ///< first column of each supernode, and the number of columns at the end
  std::vector<int> begin;   ///< where the rows of each supernode start in `rows`, and their number at the end
  std::vector<int> values;  ///< where its values start, by columns; their number at the end
  std::vector<int> rows;    ///< ascending; those of a supernode begin with its own columns
};

class SingleCholesky {
public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// `lower`: the lower triangle whose pattern was analysed.
  SingleCholesky(const Matrix& lower, SupernodalPattern pattern);

  /// `lower` has the pattern of the constructor's. False where a pivot is not positive.
  bool factorise(const Matrix& lower);
  /// x with A x = b, to what single precision gives. Needs a factor.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

private:
  bool eliminate(int supernode);
  void update(int descendant, int supernode);

  SupernodalPattern pattern_;
  std::vector<std::int32_t> places_;  // of the matrix' values in the factor's
  std::vector<int> owner_;            // supernode of each column
  std::vector<float> values_;
  std::vector<Supernode> supernodes_;
  int tallest_ = 0;
  // While factorising: which supernodes next update each one (a list), the first of their rows that it owns, the place
  // of each row in the supernode at work, those of an update's rows, and the product that is subtracted from it.
  std::vector<int> head_, next_, reached_, place_of_row_, places_of_update_;
  std::vector<float> product_;
};

}  // namespace palpate::fem
