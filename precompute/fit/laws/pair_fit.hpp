// SPDX-License-Identifier: GPL-3.0-or-later
// The response of one pair from its samples: quadratic potential, friction coefficient, slip softening.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "formats/journal/samples.hpp"
#include "precompute/fit/laws/potential_fit.hpp"

namespace palpate::fit {

struct PairResponse {
  Eigen::VectorXd coefs;   ///< see fit_potential
  double softening = 0.0;  ///< see slip_softening
};

/// Relative errors against samples: |model - sample| / max(|sample|, 2 % of the pair's peak force).
struct FitErrors {
  std::vector<double> normal;      ///< of normal samples
  std::vector<double> tangential;  ///< of tangential samples
  std::vector<double> paths;       ///< along paths that only test
};

/// Fits `samples` (at least two normal ones at increasing depths in (0, Z]). `what` names the pair in errors. The
/// coefficients are those that a file with scales.bits holds. Throws Error(numerical) on samples that are too few or
/// not finite, and when the fit does not converge.
PairResponse fit_pair(const std::vector<Sample>& samples, const ResponseScales& scales, const std::string& what);

FitErrors fit_errors(const PairResponse& response, const ResponseScales& scales, const std::vector<Sample>& samples);

}  // namespace palpate::fit
