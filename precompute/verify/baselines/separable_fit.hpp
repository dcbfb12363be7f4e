// SPDX-License-Identifier: GPL-3.0-or-later
// The response of one pair from its samples: the curves of the separable model, or the coupled model's coefficients.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "formats/samples.hpp"
#include "precompute/fit/coupled_fit.hpp"

namespace palpate::fit {

/// What all responses of a file share.
struct ModelScales {
  double depth = 0.0;     ///< Z, m, > 0
  double sideways = 0.0;  ///< X, m; 0: no sideways pushes were solved (frictionless)
  int normal_coefs = 10, lateral_coefs = 5, growth_coefs = 5, sideways_coefs = 7, friction_coefs = 5;
  std::optional<palpate::coupled::Degrees>
      coupled;    ///< of the coupled model, which has no such curves; none: separable
  int bits = 16;  ///< of its coefficients in the file, 8, 12 or 16

  [[nodiscard]] bool friction() const noexcept { return sideways > 0; }
};

inline CoupledScales coupled_scales(const ModelScales& scales) {
  return {scales.depth, scales.sideways, *scales.coupled};
}

/// Spline coefficients; the friction families are empty in a frictionless file.
struct PairCurves {
  Eigen::VectorXd normal, lateral_x, lateral_y;  ///< N
  Eigen::VectorXd growth_x, growth_y;            ///< dimensionless, last coefficient 1
  Eigen::VectorXd sideways_x, sideways_y;        ///< N
  Eigen::VectorXd friction;                      ///< dimensionless
  Eigen::VectorXd coupled;                       ///< in place of all those: see fit_coupled
  double relief = 0.0;                           ///< see slip_relief
};

/// Relative errors of curves against samples: |model - sample| / max(|sample|, 2 % of the pair's peak force).
struct FitErrors {
  std::vector<double> normal;      ///< of straight pushes
  std::vector<double> tangential;  ///< of sideways pushes
  std::vector<double> paths;       ///< along paths that only test
};

/// Fits `samples` (at least two straight pushes at increasing depths in (0, Z]). `what` names the pair in errors.
/// Throws Error(numerical) on samples that are too few or not finite, and when the fit does not converge.
PairCurves fit_pair(const std::vector<Sample>& samples, const ModelScales& scales, const std::string& what);

/// Force (x, y, n) at a deflection (x, y sideways, depth; m) inside the fitted range (depth is clamped to [0, Z],
/// sideways to [-X, X], save by the coupled model, which goes on there).
Eigen::Vector3d evaluate(const PairCurves& curves, const ModelScales& scales, const Eigen::Vector3d& deflection);

/// mu at a depth (m); 0 in a frictionless file.
double evaluate_friction(const PairCurves& curves, const ModelScales& scales, double depth);

FitErrors fit_errors(const PairCurves& curves, const ModelScales& scales, const std::vector<Sample>& samples);

}  // namespace palpate::fit
