// SPDX-License-Identifier: GPL-3.0-or-later
// A response from samples that a real tool recorded: noisy, with outliers among them.
#pragma once

#include <string>
#include <vector>

#include "precompute/fit/laws/pair_fit.hpp"

namespace palpate::fit {

struct RecordedFit {
  PairResponse response;
  std::vector<std::size_t> outliers;  ///< samples that were left out, ascending
  double rms = 0.0, worst = 0.0;      ///< N, distance of the others from the fit
  double depth = 0.0;                 ///< m, deepest normal sample among the others
};

/// Throws Error(bad_input) "what: cause" unless the samples suffice for a response, are not too many, reach half of
/// `depth` (m), and in a scene with friction go aside to four sides.
void check_recorded(const std::vector<Sample>& samples, double depth, bool friction, const std::string& what);

/// Least trimmed squares with concentration steps (Rousseeuw and Van Driessen 2006), then a last fit without the
/// outliers; what is near a curve and what is not: see formats/recording/recording-file.md. A sample whose noise is
/// more than a hundredth of its force has a smaller weight. Only the ratios of weights (> 0) matter. Throws as
/// check_recorded, of all samples and of those that are no outliers, and Error(bad_input) "what: cause" where the
/// samples are not good for a response or no curve can be fitted to them.
RecordedFit fit_recorded(const std::vector<Sample>& recorded, double depth, const ResponseScales& scales,
                         const std::string& what);

}  // namespace palpate::fit
