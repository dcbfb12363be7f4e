// SPDX-License-Identifier: GPL-3.0-or-later
// How far two solves of one contact are apart.
#pragma once

#include "formats/journal/samples.hpp"

#include <vector>

namespace palpate {

struct SampleDifference {
  double straight = 0.0;     ///< largest |F - F'| / |F'| over the deeper half of the straight push
  double sideways = 0.0;     ///< the same over the sideways pushes
  std::size_t compared = 0;  ///< samples that had a partner: straight ones of any depth, sideways ones
  std::size_t foretold = 0;  ///< of these: differ by no more than their error estimates together
  double stiffness = 0.0;    ///< largest relative difference of a sideways push's secant stiffness at its first point
};

/// Difference of samples along one path. Normal indentations are matched from full depth, because shallow points may be
/// missing, and compared at the depths of `samples`.
SampleDifference sample_difference(const std::vector<Sample>& samples, const std::vector<Sample>& reference);

/// Force of a straight push at a depth (m) near `here`, by the power law through it and a neighbour on its curve.
Eigen::Vector3d force_at(const Sample& here, const Sample& neighbour, double depth);

}  // namespace palpate
