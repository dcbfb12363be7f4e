// SPDX-License-Identifier: GPL-3.0-or-later
// How far two solves of one contact are apart.
#pragma once

#include "formats/samples.hpp"

#include <vector>

namespace palpate {

struct SampleDifference {
  double straight = 0.0;     ///< largest |F - F'| / |F'| over the deeper half of the straight push
  double sideways = 0.0;     ///< the same over the sideways pushes
  std::size_t compared = 0;  ///< samples that had a partner
  double stiffness = 0.0;    ///< largest relative difference of a sideways push's secant stiffness at its first point
};

/// Of samples along one path; straight pushes are matched from full depth, since shallow points may be missing.
SampleDifference sample_difference(const std::vector<Sample>& samples, const std::vector<Sample>& reference);

}  // namespace palpate
