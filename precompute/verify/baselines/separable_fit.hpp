// SPDX-License-Identifier: GPL-3.0-or-later
// The separable field of Mahvash and Hayward 2004, fitted to one pair: a baseline of `palpate bench --models`.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "formats/journal/samples.hpp"

namespace palpate::verify {

/// Spline coefficients over s = sqrt(z / Z), those of phi over (x / X + 1) / 2:
///
///     force = Fx(s) x + Fy(s) y + Fn(s) n + gx(s) phix(x / X) x + gy(s) phiy(y / X) y
///
/// The friction families are empty without friction.
struct SeparableField {
  double depth = 0.0;                 ///< m, Z
  double tangential = 0.0;            ///< m, X; 0 without friction
  Eigen::VectorXd normal;             ///< Fn (N)
  Eigen::VectorXd bias_x, bias_y;     ///< Fx, Fy (N)
  Eigen::VectorXd growth_x, growth_y; ///< gx, gy; the last coefficient is 1
  Eigen::VectorXd phi_x, phi_y;       ///< N

  /// Force (x, y, n; N) at a deflection (x, y tangential, depth; m), clamped to [-X, X] and [0, Z].
  [[nodiscard]] Eigen::Vector3d force(const Eigen::Vector3d& deflection) const;
  /// Bytes of a response in a file, with the curve of the friction coefficient.
  [[nodiscard]] static double bytes(bool friction);
};

/// Fits normal and, where `tangential` > 0, tangential samples. `depth`, `tangential`: Z and X (m). Throws
/// Error(numerical) naming `what` on samples that are too few or not finite, and when the fit does not converge.
SeparableField fit_separable(const std::vector<Sample>& samples, double depth, double tangential,
                             const std::string& what);

}  // namespace palpate::verify
