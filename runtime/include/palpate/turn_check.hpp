// SPDX-License-Identifier: MIT
// The rules that a response of TURN keeps with that of GRASP.
#pragma once

#include "palpate/turn_law.hpp"

#include <cmath>

namespace palpate::grasp {

/// How far the stiffness of moves and turns together is from semidefinite: it stays positive definite when this share
/// of its diagonal is taken off.
inline constexpr double kTurnMargin = 1e-6;

/// Whether the stiffness of one coefficient (see stiffness()) is positive definite by that margin.
inline bool is_positive(const double* move, const double* turn) {
  double m[5][6];
  stiffness(move, turn, m);
  for (int i = 0; i < 5; ++i) {
    m[i][i] *= 1 - kTurnMargin;
    m[i][5] = 0;
  }
  return solve_positive(m);
}

/// What is wrong with the curves of a tool that turns, n coefficients each; null: nothing.
inline const char* broken_turn(const float* grasp, const float* turn, int n) {
  constexpr float kLargest = 1e12f;  // N, N m
  const int curves = static_cast<int>(layout::kTurnCurves);
  for (int i = 0; i < curves * n; ++i) {
    if (!(std::fabs(turn[i]) <= kLargest)) return "curves must be finite";
  }
  for (int k = 3; k < curves; ++k) {
    const float* c = turn + k * n;
    if (c[0] != c[1] || c[n - 1] != c[n - 2]) return "stiffness and coupling must be level at their ends";
  }
  for (int i = 0; i < n; ++i) {
    double move[3], turned[12];
    for (int k = 0; k < 3; ++k) move[k] = static_cast<double>(grasp[(3 + k) * n + i]);
    for (int k = 0; k < 12; ++k) turned[k] = static_cast<double>(turn[(3 + k) * n + i]);
    if (!is_positive(move, turned)) return "stiffness of moves and turns must be positive definite";
  }
  return nullptr;
}

}  // namespace palpate::grasp
