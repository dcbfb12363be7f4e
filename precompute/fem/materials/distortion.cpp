// SPDX-License-Identifier: GPL-3.0-or-later
// Chain rule of D = g(J) F.
#include "precompute/fem/materials/distortion.hpp"

#include "precompute/fem/materials/determinant.hpp"
#include "precompute/fem/materials/guarded.hpp"

namespace palpate::fem {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

// g and its derivatives in J.
Guarded shrink(double j) { return guarded_power(j, -1.0 / 3, kFlattest); }

}  // namespace

double Distortion::energy(const Matrix3d& f, const Vector3d& fibre) const {
  const Matrix3d d = shrink(f.determinant()).value * f;
  double sum = 0.5 * mu_ * (d.squaredNorm() - 3);
  for (const auto& law : laws_) sum += law->energy(d, fibre);
  return sum;
}

double Distortion::distorted(const Matrix3d& d, const Vector3d& fibre, Matrix3d& slope) const {
  double sum = 0.5 * mu_ * (d.squaredNorm() - 3);
  slope = mu_ * d;
  Matrix3d part;
  for (const auto& law : laws_) {
    sum += law->stress(d, fibre, part);
    slope += part;
  }
  return sum;
}

double Distortion::stress(const Matrix3d& f, const Vector3d& fibre, Matrix3d& stress) const {
  const Matrix3d c = cofactor(f);
  const Guarded g = shrink(f.determinant());
  Matrix3d p;  // dW/dD
  const double energy = distorted(g.value * f, fibre, p);
  stress = g.value * p + g.first * p.cwiseProduct(f).sum() * c;
  return energy;
}

// With p = dW/dD, A = d2W/dD2, f = F and c = cof F stacked, and s = p . f:
//   g^2 A + g g' (A f c^T + c f^T A) + g' (p c^T + c p^T) + (g'^2 f^T A f + g'' s) c c^T + g' s d2J.
Tangent Distortion::tangent(const Matrix3d& f, const Vector3d& fibre) const {
  const Guarded g = shrink(f.determinant());
  const Matrix3d d = g.value * f;
  Matrix3d slope;
  distorted(d, fibre, slope);
  Tangent a = mu_ * Tangent::Identity();
  for (const auto& law : laws_) a += law->tangent(d, fibre);
  using Stacked = Eigen::Matrix<double, 9, 1>;
  const Stacked at = stacked(f), c = stacked(cofactor(f)), p = stacked(slope), af = a * at;
  const double s = p.dot(at);
  const Stacked mixed = g.value * g.first * af + g.first * p;
  Tangent t = g.value * g.value * a + mixed * c.transpose() + c * mixed.transpose() +
              (g.first * g.first * at.dot(af) + g.second * s) * c * c.transpose();
  add_curvature_of_j(f, g.first * s, t);
  return t;
}

}  // namespace palpate::fem
