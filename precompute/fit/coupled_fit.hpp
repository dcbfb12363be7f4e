// SPDX-License-Identifier: GPL-3.0-or-later
// The coefficients of the coupled model for one pair: least squares under the inequalities that make it passive.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/samples.hpp"
#include "palpate/coupled.hpp"

namespace palpate::fit {

/// What all responses of a file share.
struct CoupledScales {
  double depth = 0.0;     ///< Z, m
  double sideways = 0.0;  ///< X, m
  coupled::Degrees degrees;
};

/// Fits straight and sideways pushes (others are passed over); each counts by 1 / max(|force|, 2 % of the peak), less
/// where its error estimate is large. The result is in N (the friction limit's part as it is), in the file's order, and
/// meets coupled::broken_rule. Throws Error(numerical) naming `what` on samples that are too few or not finite, and
/// when the fit does not converge.
Eigen::VectorXd fit_coupled(const std::vector<Sample>& samples, const CoupledScales& scales, const std::string& what);

/// Of those coefficients the friction limit's, where the relief is this.
Eigen::VectorXd fit_limit(const std::vector<Sample>& samples, const CoupledScales& scales, double relief,
                          const std::string& what);

/// The law of such coefficients.
coupled::Law make_law(const Eigen::VectorXd& coefs, const CoupledScales& scales);

/// Force (x, y, n) of a deflection (x, y sideways, depth; m) that was reached by a push straight down, then sideways.
Eigen::Vector3d evaluate(const coupled::Law& law, const CoupledScales& scales, const Eigen::Vector3d& deflection);

/// The same with `sideways` (m), the effective one, for any past.
Eigen::Vector3d evaluate(const coupled::Law& law, const CoupledScales& scales, const Eigen::Vector2d& sideways,
                         double depth);

/// The effective sideways deflection (m) that is left of `sideways` after going deeper without moving sideways.
Eigen::Vector2d deepened(const coupled::Law& law, const CoupledScales& scales, double from, double to,
                         const Eigen::Vector2d& sideways);

/// Coefficients as the file has them: whole numbers, those of forces times `unit` N, of the limit times
/// layout::kLimitUnit.
struct Quantised {
  float unit = 0.0f;
  std::vector<std::int16_t> coefs;
};

/// The nearest whole numbers that keep the inequalities, of `bits` (8, 12 or 16) each, those of the limit of 16. Throws
/// Error(numerical) where a limit is above 10.
Quantised quantise(const Eigen::VectorXd& coefs, const coupled::Degrees& degrees, int bits, const std::string& what);

/// The coefficients that a file with so many bits has in place of these.
Eigen::VectorXd rounded(const Eigen::VectorXd& coefs, const coupled::Degrees& degrees, int bits,
                        const std::string& what);

}  // namespace palpate::fit
