// SPDX-License-Identifier: GPL-3.0-or-later
// Spectral form: W = sum g(c) over the eigenvalues c of C = F^T F.
#include "precompute/fem/materials/ogden.hpp"

#include "precompute/algebra/spectrum.hpp"
#include "precompute/fem/materials/guarded.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::fem {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Values of g and its derivatives at the three eigenvalues.
struct Ogden::Principal {
  Principal(const std::vector<Term>& terms, const Matrix3d& f) {
    const auto eigen = algebra::spectrum<3>(f.transpose() * f);
    directions = eigen.vectors;
    for (int k = 0; k < 3; ++k) {
      c[k] = eigen.values[k];
      g[k] = at(terms, c[k]);
    }
  }

  static Guarded at(const std::vector<Term>& terms, double c) {
    Guarded sum{0, 0, 0};
    for (const Term& term : terms) {
      const Guarded p = guarded_power(c, 0.5 * term.alpha, kFlattest);
      const double scale = term.mu / term.alpha;
      sum.value += scale * (p.value - 1);
      sum.first += scale * p.first;
      sum.second += scale * p.second;
    }
    return sum;
  }

  [[nodiscard]] double energy() const { return g[0].value + g[1].value + g[2].value; }
  // Second Piola-Kirchhoff stress, 2 dW/dC.
  [[nodiscard]] Matrix3d stress() const {
    return directions * (2 * Vector3d(g[0].first, g[1].first, g[2].first)).asDiagonal() * directions.transpose();
  }

  Matrix3d directions;
  double c[3];
  Guarded g[3];
};

double Ogden::energy(const Matrix3d& f, const Vector3d& /*fibre*/) const { return Principal(terms_, f).energy(); }

double Ogden::stress(const Matrix3d& f, const Vector3d& /*fibre*/, Matrix3d& stress) const {
  const Principal p(terms_, f);
  stress = f * p.stress();
  return p.energy();
}

Tangent Ogden::tangent(const Matrix3d& f, const Vector3d& /*fibre*/) const {
  const Principal p(terms_, f);
  const Matrix3d s = p.stress(), turned = f * p.directions;
  // dS in the principal basis: (S_i - S_j) / (c_i - c_j) dC_ij.
  Matrix3d rate;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double gap = p.c[i] - p.c[j];
      const bool close = std::abs(gap) <= 1e-5 * std::max({p.c[i], p.c[j], kFlattest});
      rate(i, j) =
          close ? 2 * Principal::at(terms_, 0.5 * (p.c[i] + p.c[j])).second : 2 * (p.g[i].first - p.g[j].first) / gap;
    }
  }
  Tangent t;
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < 3; ++i) {
      Matrix3d d = Matrix3d::Zero();
      d(i, a) = 1;
      const Matrix3d half = turned.transpose() * d * p.directions;
      const Matrix3d ds = rate.cwiseProduct(half + half.transpose());
      const Matrix3d dp = d * s + turned * ds * p.directions.transpose();
      t.col(i + 3 * a) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(dp.data());
    }
  }
  return t;
}

}  // namespace palpate::fem
