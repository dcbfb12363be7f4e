// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/algebra/spectrum.hpp"

#include <Eigen/Eigenvalues>

namespace palpate::algebra {

namespace {

// Two sizes are compiled: 3, whose direct reduction most laws use, and any.
template <class Matrix, int N>
Spectrum<N> solved_as(const Eigen::Matrix<double, N, N>& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(symmetric);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

}  // namespace

template <int N>
Spectrum<N> spectrum(const Eigen::Matrix<double, N, N>& symmetric) {
  return solved_as<Eigen::MatrixXd>(symmetric);
}

template <>
Spectrum<3> spectrum(const Eigen::Matrix3d& symmetric) {
  return solved_as<Eigen::Matrix3d>(symmetric);
}

template Spectrum<2> spectrum(const Eigen::Matrix2d&);
template Spectrum<9> spectrum(const Eigen::Matrix<double, 9, 9>&);
template Spectrum<Eigen::Dynamic> spectrum(const Eigen::MatrixXd&);

}  // namespace palpate::algebra
