// SPDX-License-Identifier: MIT
// Compliance of an elastic half-space between two points of a body's surface, in closed form.
#pragma once

#include "palpate/format/full_turn.hpp"

#include <cmath>

namespace palpate::half_space {

/// A point of a surface with the elasticity below it.
struct Point {
  double position[3];  ///< m
  double normal[3];    ///< outward unit
  double shear;        ///< Pa, shear modulus, > 0
};

/// Writes the displacement of `to` (m) by a unit force (N) at `from`, row by row: u_i = compliance[3 i + j] f_j.
/// Boussinesq's solution for the force along the normal, Cerruti's for the forces across it (Johnson 1985, chapter 3):
///
///     C = w / (4 pi G rho) (2 (1 - nu) I + 2 nu t t^T + (1 - 2 nu) (t n^T - n t^T))
///
///     n    unit(n_from + n_to)                        w    |n_from + n_to|^2 / 4: 1 on a plane, 0 between two faces
///     t    part of (to - from) across n, over rho     rho  sqrt(|to - from|^2 + rounding^2)
///     G    sqrt(shear moduli)                         nu   `poisson`, [0, 0.5)
///
/// `rounding` (m, > 0) keeps C finite where the points meet. C(a, b) is the transpose of C(b, a).
inline void compliance(const Point& from, const Point& to, double poisson, double rounding, double (&compliance)[9]) {
  double sum[3], d[3], square = 0, distance = rounding * rounding, along = 0;
  for (int i = 0; i < 3; ++i) {
    sum[i] = from.normal[i] + to.normal[i];
    d[i] = to.position[i] - from.position[i];
    square += sum[i] * sum[i];
    distance += d[i] * d[i];
  }
  const double rho = std::sqrt(distance);
  const double scale = 0.25 * square / (2 * kFullTurn * std::sqrt(from.shear * to.shear) * rho);
  const double size = square > 0 ? 1 / std::sqrt(square) : 0;
  double n[3], t[3];
  for (int i = 0; i < 3; ++i) {
    n[i] = size * sum[i];
    along += n[i] * d[i];
  }
  for (int i = 0; i < 3; ++i) t[i] = (d[i] - along * n[i]) / rho;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      compliance[3 * i + j] = scale * ((i == j ? 2 * (1 - poisson) : 0) + 2 * poisson * t[i] * t[j] +
                                       (1 - 2 * poisson) * (t[i] * n[j] - n[i] * t[j]));
    }
  }
}

}  // namespace palpate::half_space
