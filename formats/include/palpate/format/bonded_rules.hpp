// SPDX-License-Identifier: MIT
// The inequality that joins the curves of BONDED and BONDED_TORQUE, and the matrix that it is about.
#pragma once

#include "palpate/format/response_layout.hpp"

#include <cmath>

namespace palpate::bonded {

/// Share of the diagonal that is taken off before a stiffness is tested for positive definiteness.
inline constexpr double kDefiniteMargin = 1e-6;

/// Solves the symmetric system m x = b. b is the last column, which ends as x.
/// Returns false when m is not positive definite.
inline bool solve_positive(double (&m)[5][6]) {
  for (int i = 0; i < 5; ++i) {
    if (!(m[i][i] > 0)) return false;
    for (int j = i + 1; j < 5; ++j) {
      const double share = m[j][i] / m[i][i];
      for (int k = i; k < 6; ++k) m[j][k] -= share * m[i][k];
    }
  }
  for (int i = 4; i >= 0; --i) {
    for (int k = i + 1; k < 5; ++k) m[i][5] -= m[i][k] * m[k][5];
    m[i][5] /= m[i][i];
  }
  return true;
}

/// Fills the first five columns of m with the stiffness of (x, y, rotation vector).
/// `translation`: kxx, kxy, kyy. `rotation`: K and C in the order of layout::kTorqueCurves' last twelve.
inline void stiffness(const double* translation, const double* rotation, double (&m)[5][6]) {
  constexpr int kPlace[3][3] = {{0, 1, 3}, {1, 2, 4}, {3, 4, 5}};
  m[0][0] = translation[0];
  m[0][1] = m[1][0] = translation[1];
  m[1][1] = translation[2];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m[2 + i][2 + j] = rotation[kPlace[i][j]];
    for (int j = 0; j < 2; ++j) m[2 + i][j] = m[j][2 + i] = rotation[6 + 3 * j + i];
  }
}

/// True when the stiffness of one coefficient is positive definite by kDefiniteMargin.
inline bool is_definite(const double* translation, const double* rotation) {
  double m[5][6];
  stiffness(translation, rotation, m);
  for (int i = 0; i < 5; ++i) {
    m[i][i] *= 1 - kDefiniteMargin;
    m[i][5] = 0;
  }
  return solve_positive(m);
}

/// Null, or the rule that the curves of a rotated tool break. n coefficients a curve.
inline const char* broken_torque(const float* bonded, const float* torque, int n) {
  constexpr float kMost = 1e12f;  // N, N m
  const int curves = static_cast<int>(layout::kTorqueCurves);
  for (int i = 0; i < curves * n; ++i) {
    if (!(std::fabs(torque[i]) <= kMost)) return "curves must be finite";
  }
  for (int k = 3; k < curves; ++k) {
    const float* c = torque + k * n;
    if (c[0] != c[1] || c[n - 1] != c[n - 2]) return "stiffness and coupling must be level at their ends";
  }
  for (int i = 0; i < n; ++i) {
    double translation[3], rotation[12];
    for (int k = 0; k < 3; ++k) translation[k] = static_cast<double>(bonded[(3 + k) * n + i]);
    for (int k = 0; k < 12; ++k) rotation[k] = static_cast<double>(torque[(3 + k) * n + i]);
    if (!is_definite(translation, rotation)) return "stiffness of translation and rotation must be positive definite";
  }
  return nullptr;
}

}  // namespace palpate::bonded
