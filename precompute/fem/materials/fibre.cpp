// SPDX-License-Identifier: GPL-3.0-or-later
// Energy of the fibres' mean stretch and its derivatives.
#include "precompute/fem/materials/fibre.hpp"

#include "precompute/fem/materials/guarded.hpp"

namespace palpate::fem {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// E, dE/dF, and W with its derivatives in E.
struct Fibres::Stretch {
  Stretch(const Fibres& law, const Matrix3d& f, const Vector3d& fibre) {
    const Vector3d along = f * fibre;
    const double aligned = 1 - 3 * law.kappa_;
    const double e = law.kappa_ * (f.squaredNorm() - 3) + aligned * (along.squaredNorm() - 1);
    slope = 2 * law.kappa_ * f + 2 * aligned * along * fibre.transpose();
    if (!(e > 0)) return;
    const Guarded g = guarded_exp(law.k2_ * e * e);
    w.value = law.k1_ / (2 * law.k2_) * (g.value - 1);
    w.first = law.k1_ * e * g.first;
    w.second = law.k1_ * g.first + 2 * law.k1_ * law.k2_ * e * e * g.second;
  }
  Matrix3d slope;
  Guarded w{0, 0, 0};
};

double Fibres::energy(const Matrix3d& f, const Vector3d& fibre) const { return Stretch(*this, f, fibre).w.value; }

double Fibres::stress(const Matrix3d& f, const Vector3d& fibre, Matrix3d& stress) const {
  const Stretch s(*this, f, fibre);
  stress = s.w.first * s.slope;
  return s.w.value;
}

Tangent Fibres::tangent(const Matrix3d& f, const Vector3d& fibre) const {
  const Stretch s(*this, f, fibre);
  const Eigen::Map<const Eigen::Matrix<double, 9, 1>> slope(s.slope.data());
  Tangent t = s.w.second * slope * slope.transpose();
  t.diagonal().array() += 2 * kappa_ * s.w.first;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      t.block<3, 3>(3 * a, 3 * b).diagonal().array() += 2 * (1 - 3 * kappa_) * s.w.first * fibre[a] * fibre[b];
    }
  }
  return t;
}

}  // namespace palpate::fem
