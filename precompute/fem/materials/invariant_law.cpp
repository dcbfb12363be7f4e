// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of the invariants, and the laws that are written in them.
#include "precompute/fem/materials/invariant_law.hpp"

#include "precompute/fem/materials/determinant.hpp"
#include "precompute/fem/materials/guarded.hpp"

#include <Eigen/Geometry>

namespace palpate::fem {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

struct Invariants {
  explicit Invariants(const Matrix3d& f)
      : slope(cofactor(f)), i1(f.squaredNorm()), i2(slope.squaredNorm()), j(f.col(0).dot(slope.col(0))) {}
  Matrix3d slope;  // of j
  double i1, i2, j;
};

Matrix3d slope_of_i2(const Matrix3d& f, double i1) { return 2 * (i1 * f - f * f.transpose() * f); }

// d2 I2 = 4 (F:d)(F:d) + 2 I1 d:d - 2 (d C + F d^T F + B d):d
void add_curvature_of_i2(const Matrix3d& f, double i1, double scale, Tangent& t) {
  const Matrix3d c = f.transpose() * f, b = f * f.transpose();
  t += 4 * scale * stacked(f) * stacked(f).transpose();
  t.diagonal().array() += 2 * scale * i1;
  for (int a = 0; a < 3; ++a) {
    t.block<3, 3>(3 * a, 3 * a) -= 2 * scale * b;
    for (int k = 0; k < 3; ++k) {
      t.block<3, 3>(3 * a, 3 * k).diagonal().array() -= 2 * scale * c(a, k);
      for (int i = 0; i < 3; ++i) {
        for (int l = 0; l < 3; ++l) t(i + 3 * a, l + 3 * k) -= 2 * scale * f(i, k) * f(l, a);
      }
    }
  }
}

}  // namespace

double InvariantLaw::energy(const Matrix3d& f, const Vector3d& /*fibre*/) const {
  const Invariants i(f);
  return at(i.i1, i.i2, i.j).value;
}

double InvariantLaw::stress(const Matrix3d& f, const Vector3d& /*fibre*/, Matrix3d& stress) const {
  const Invariants i(f);
  const InvariantEnergy w = at(i.i1, i.i2, i.j);
  stress = 2 * w.first[0] * f + w.first[1] * slope_of_i2(f, i.i1) + w.first[2] * i.slope;
  return w.value;
}

Tangent InvariantLaw::tangent(const Matrix3d& f, const Vector3d& /*fibre*/) const {
  const Invariants i(f);
  const InvariantEnergy w = at(i.i1, i.i2, i.j);
  Eigen::Matrix<double, 9, 3> slopes;
  slopes << stacked(2 * f), stacked(slope_of_i2(f, i.i1)), stacked(i.slope);
  Tangent t = slopes * w.second * slopes.transpose();
  t.diagonal().array() += 2 * w.first[0];
  if (w.first[1] != 0) add_curvature_of_i2(f, i.i1, w.first[1], t);
  if (w.first[2] != 0) add_curvature_of_j(f, w.first[2], t);
  return t;
}

InvariantEnergy SecondInvariant::at(double /*i1*/, double i2, double /*j*/) const {
  InvariantEnergy w;
  w.value = c_ * (i2 - 3);
  w.first[1] = c_;
  return w;
}

InvariantEnergy Exponential::at(double i1, double i2, double /*j*/) const {
  const Guarded e = guarded_exp(beta_ * (i1 - 3));
  InvariantEnergy w;
  w.value = c1_ * (e.value - 1) + c2_ * (i2 - 3);
  w.first = {c1_ * beta_ * e.first, c2_, 0};
  w.second(0, 0) = c1_ * beta_ * beta_ * e.second;
  return w;
}

InvariantEnergy StVenantKirchhoff::at(double i1, double i2, double /*j*/) const {
  // tr E = (I1 - 3) / 2 and E:E = (I1^2 - 2 I2 - 2 I1 + 3) / 4.
  InvariantEnergy w;
  w.value = lambda_ / 8 * (i1 - 3) * (i1 - 3) + mu_ / 4 * (i1 * i1 - 2 * i2 - 2 * i1 + 3);
  w.first = {lambda_ / 4 * (i1 - 3) + mu_ / 2 * (i1 - 1), -mu_ / 2, 0};
  w.second(0, 0) = lambda_ / 4 + mu_ / 2;
  return w;
}

InvariantEnergy Volume::at(double /*i1*/, double /*i2*/, double j) const {
  InvariantEnergy w;
  w.value = slope_ * (j - 1) + 0.5 * bulk_ * (j - 1) * (j - 1);
  w.first[2] = slope_ + bulk_ * (j - 1);
  w.second(2, 2) = bulk_;
  return w;
}

}  // namespace palpate::fem
