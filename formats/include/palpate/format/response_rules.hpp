// SPDX-License-Identifier: MIT
// The inequalities that make a response passive. A fit keeps them and a reader checks them.
#pragma once

#include "palpate/format/response_coefficients.hpp"

#include <cmath>

/// For every index i of K' and A, with m the mean and h the second harmonic of a symmetric 2x2 matrix,
///
///     m(K' + A) - |h(K' + A)| >= 0,   m(K' - A) - |h(K' - A)| >= 0,
///
/// which is -K' <= A <= K' as matrices at every depth, because Bernstein's polynomials are not negative.
namespace palpate::response {

/// Smallest eigenvalue (N) of K' + sign A at coefficient `index`. Requires friction.
template <class Scalar>
double least_stiffness(const Scalar* coefs, const Degrees& d, int index, int sign) {
  const Offsets o = offsets(d);
  double k[3];
  for (int c = 0; c < 3; ++c) {
    k[c] = static_cast<double>(coefs[o.stiffness + 3 * index + c]);
    if (index >= 2) k[c] += sign * static_cast<double>(coefs[o.coupling + 3 * (index - 2) + c]);
  }
  return k[0] - std::sqrt(k[1] * k[1] + k[2] * k[2]);
}

/// Null, or the rule that the coefficients break: F begins at zero and does not decrease, mu lies in
/// [0, largest_friction], and -K' <= A <= K'.
template <class Scalar>
const char* broken_rule(const Scalar* coefs, const Degrees& d, double largest_friction) {
  const Offsets o = offsets(d);
  double last = 0, scale = 0;
  for (int k = 0; k < o.bias; ++k) {
    const auto value = static_cast<double>(coefs[k]);
    if (!(value >= last)) return "the normal force must start at zero and not decrease";
    last = value;
  }
  if (!d.friction_families) return nullptr;
  for (int k = o.friction; k < o.end; ++k) {
    const auto value = static_cast<double>(coefs[k]);
    if (!(value >= 0 && value <= largest_friction)) return "the friction coefficient is out of 0 to 10";
  }
  for (int k = o.stiffness; k < o.friction; ++k) scale = std::fmax(scale, std::fabs(static_cast<double>(coefs[k])));
  for (int i = 0; i <= d.stiffness; ++i) {
    const double least = -1e-12 * scale;  // round-off of the square roots alone
    if (!(least_stiffness(coefs, d, i, 1) >= least) || !(least_stiffness(coefs, d, i, -1) >= least)) {
      return "stiffness and coupling break the passivity inequalities -K' <= A <= K'";
    }
  }
  return nullptr;
}

}  // namespace palpate::response
