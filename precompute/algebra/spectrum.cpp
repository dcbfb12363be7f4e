// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/algebra/spectrum.hpp"

#include <Eigen/Eigenvalues>

namespace palpate {

template <int N>
Spectrum<N> spectrum(const Eigen::Matrix<double, N, N>& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> eigen(symmetric);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

template Spectrum<2> spectrum(const Eigen::Matrix2d&);
template Spectrum<3> spectrum(const Eigen::Matrix3d&);
template Spectrum<9> spectrum(const Eigen::Matrix<double, 9, 9>&);
template Spectrum<Eigen::Dynamic> spectrum(const Eigen::MatrixXd&);

}  // namespace palpate
