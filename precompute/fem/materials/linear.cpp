// SPDX-License-Identifier: GPL-3.0-or-later
// Hooke's law.
#include "precompute/fem/materials/linear.hpp"

namespace palpate::fem {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double Linear::energy(const Matrix3d& f, const Vector3d& fibre) const {
  Matrix3d unused;
  return stress(f, fibre, unused);
}

double Linear::stress(const Matrix3d& f, const Vector3d& /*fibre*/, Matrix3d& stress) const {
  const Matrix3d e = 0.5 * (f + f.transpose()) - Matrix3d::Identity();
  const double trace = e.trace();
  stress = 2 * mu_ * e;
  stress.diagonal().array() += lambda_ * trace;
  return mu_ * e.squaredNorm() + 0.5 * lambda_ * trace * trace;
}

Tangent Linear::tangent(const Matrix3d& /*f*/, const Vector3d& /*fibre*/) const {
  Tangent t = Tangent::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int a = 0; a < 3; ++a) {
      t(i + 3 * a, i + 3 * a) += mu_;
      t(i + 3 * a, a + 3 * i) += mu_;
      t(i + 3 * i, a + 3 * a) += lambda_;
    }
  }
  return t;
}

}  // namespace palpate::fem
