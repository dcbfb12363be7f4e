// SPDX-License-Identifier: GPL-3.0-or-later
// Eigenvalues of symmetric matrices, compiled once: Eigen's solver costs a compiler 5 to 10 s wherever it is met anew.
#pragma once

#include <Eigen/Core>

namespace palpate::algebra {

template <int N>
struct Spectrum {
  Eigen::Vector<double, N> values;      ///< ascending
  Eigen::Matrix<double, N, N> vectors;  ///< a column for each value; orthonormal
};

/// Eigenvalues and eigenvectors of a symmetric matrix, of which the lower half is read (Eigen::SelfAdjointEigenSolver).
/// N is 2, 3, 9 or Eigen::Dynamic.
template <int N>
Spectrum<N> spectrum(const Eigen::Matrix<double, N, N>& symmetric);

}  // namespace palpate::algebra
