// SPDX-License-Identifier: GPL-3.0-or-later
// Hyperelastic laws in the split form of the P2/P0 element: a deviatoric energy at quadrature points and a
// volumetric energy of the element's mean dilatation.
#pragma once

#include <Eigen/Core>

namespace palpate {

/// Compressible neo-Hookean solid,
///   psi(F) = mu/2 (F:F - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2,
/// polynomial in F and hence defined for inverted elements too; its small-strain limit is Hooke's law with
/// the Lame constants (mu, lambda) (the form of Smith, de Goes and Kim 2018, equation 14, up to a constant).
struct NeoHookean {
  double mu = 0.0;      ///< Pa
  double lambda = 0.0;  ///< Pa

  /// young > 0 (Pa), poisson in [0, 0.5).
  static NeoHookean from_young(double young, double poisson) {
    return {young / (2 * (1 + poisson)), young * poisson / ((1 + poisson) * (1 - 2 * poisson))};
  }

  /// mu/2 (F:F - 3), evaluated at quadrature points (Pa); its gradient is mu F, its Hessian mu I.
  [[nodiscard]] double deviatoric(const Eigen::Matrix3d& f) const { return 0.5 * mu * (f.squaredNorm() - 3.0); }

  /// Energy of the mean dilatation j (Pa) and its derivatives.
  [[nodiscard]] double volumetric(double j) const { return -mu * (j - 1) + 0.5 * (lambda + mu) * (j - 1) * (j - 1); }
  [[nodiscard]] double volumetric_slope(double j) const { return -mu + (lambda + mu) * (j - 1); }
  [[nodiscard]] double volumetric_curvature() const { return lambda + mu; }
};

}  // namespace palpate
