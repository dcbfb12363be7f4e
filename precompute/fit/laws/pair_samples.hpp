// SPDX-License-Identifier: GPL-3.0-or-later
// The samples of one pair as fits read them: sorted, checked, weighted.
#pragma once

#include <string>
#include <vector>

#include "formats/journal/samples.hpp"

namespace palpate::fit {

struct PairSamples {
  std::vector<const Sample*> normal;      ///< by depth; at least two
  std::vector<const Sample*> tangential;  ///< as they came
  double peak = 0.0;                      ///< N, largest force of a normal indentation, > 0

  /// The sample's own weight / max(|force|, 2 % of the peak).
  [[nodiscard]] double weight(const Sample& sample) const;
};

/// The normal indentations and tangential pushes; others are passed over: what slips, or went another way, answers to
/// more than the contact's deflection. `samples` must outlive the result. Throws Error(numerical) "what: ..." when a
/// sample is not finite or there are fewer than two normal indentations deeper than 0 with a force.
PairSamples sort_samples(const std::vector<Sample>& samples, const std::string& what);

}  // namespace palpate::fit
