// SPDX-License-Identifier: GPL-3.0-or-later
// What all laws share.
#include "precompute/fem/law.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace palpate {

Tangent positive_part(const Tangent& tangent) {
  const Eigen::SelfAdjointEigenSolver<Tangent> eigen(tangent);
  const double least = 1e-6 * std::max(0.0, eigen.eigenvalues()[8]);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(least).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace palpate
