// SPDX-License-Identifier: GPL-3.0-or-later
// Volume terms from the small-strain moduli of an energy, and sums over its laws.
#include "precompute/fem/materials/material.hpp"

#include "precompute/fem/materials/invariant_law.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace palpate::fem {

using Eigen::Matrix3d;

namespace {

// The stress at F = I is this times I: nothing but direction-free laws push there.
double stress_at_rest(const Material& m) {
  Matrix3d p;
  m.stress(Matrix3d::Identity(), p);
  return p.trace() / 3;
}

// d : dP/dF : d at F = I of everything but the volume term.
double curvature_at_rest(const Material& m, const Matrix3d& d) {
  const Eigen::Map<const Eigen::Matrix<double, 9, 1>> v(d.data());
  return m.mu * v.squaredNorm() + v.dot(m.law_tangent(Matrix3d::Identity()) * v);
}

}  // namespace

Material Material::neo_hookean(double young, double poisson) { return of(young / (2 * (1 + poisson)), {}, poisson); }

Material Material::of(double mu, std::vector<std::shared_ptr<const Law>> laws, double poisson) {
  Material m;
  m.mu = mu;
  m.laws = std::move(laws);
  const double pressure = stress_at_rest(m);
  m.slope = -pressure;
  const double shear = m.shear_modulus();
  if (!(shear > 0) || !std::isfinite(shear)) throw std::invalid_argument("the shear modulus at rest is not positive");
  const double wanted = 2 * shear * (1 + poisson) / (3 * (1 - 2 * poisson));
  const double missing = -m.bulk_modulus();
  m.bulk = wanted + missing;
  m.local = std::max(missing, 0.0);
  return m;
}

Material Material::plain() const {
  Material m = *this;
  m.laws.push_back(std::make_shared<Volume>(slope, bulk));
  m.slope = m.bulk = m.local = 0;
  return m;
}

double Material::shear_modulus() const {
  // Of F = I + e d with d symmetric and free of trace, psi'' = 2 G d:d, of which the volume term gives -slope d:d.
  Matrix3d d = Matrix3d::Zero();
  d(0, 1) = d(1, 0) = 1;
  return 0.25 * curvature_at_rest(*this, d) - 0.5 * slope;
}

double Material::bulk_modulus() const {
  // Of F = (1 + e) I the second derivative of psi is 9 times the bulk modulus, j'' = 6 and j' = 3.
  return (curvature_at_rest(*this, Matrix3d::Identity()) + 6 * slope) / 9 + bulk;
}

double Material::deviatoric(const Matrix3d& f) const {
  double sum = 0.5 * mu * (f.squaredNorm() - 3.0);
  for (const auto& law : laws) sum += law->energy(f, fibre);
  return sum;
}

double Material::stress(const Matrix3d& f, Matrix3d& stress) const {
  double sum = 0.5 * mu * (f.squaredNorm() - 3.0);
  stress = mu * f;
  Matrix3d part;
  for (const auto& law : laws) {
    sum += law->stress(f, fibre, part);
    stress += part;
  }
  return sum;
}

Tangent Material::law_tangent(const Matrix3d& f) const {
  Tangent sum = Tangent::Zero();
  for (const auto& law : laws) sum += law->tangent(f, fibre);
  return sum;
}

}  // namespace palpate::fem
