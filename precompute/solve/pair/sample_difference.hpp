// SPDX-License-Identifier: GPL-3.0-or-later
// How far two solves of one contact are apart.
#pragma once

#include "formats/journal/samples.hpp"

#include <cstddef>
#include <vector>

namespace palpate::solve {

/// A sample beside its partner in the reference.
struct ComparedSample {
  std::size_t sample = 0, other = 0;  ///< numbers among the samples and in the reference
  double difference = 0.0;            ///< |F - F'| / |F'|
};

struct SampleDifference {
  double normal = 0.0;              ///< largest |F - F'| / |F'| over the deeper half of the normal indentation
  double tangential = 0.0;          ///< the same over the tangential pushes
  std::size_t compared = 0;         ///< samples that had a partner: normal ones of any depth, tangential ones
  std::size_t within_estimate = 0;  ///< of these: differ by no more than their error estimates together
  double stiffness = 0.0;  ///< largest relative difference of a tangential push's secant stiffness at its first point
  std::vector<ComparedSample> samples;  ///< every one that had a partner
};

/// Difference of samples along one path, or along a part of it. A sample's partner is the one of its kind with the
/// nearest deflection, at most 15 % away: either solve may lack points. Normal ones are compared at the depths of
/// `samples`.
SampleDifference sample_difference(const std::vector<Sample>& samples, const std::vector<Sample>& reference);

/// Force of a normal indentation at a depth (m) near `here`, by the power law through it and a neighbour on its curve.
Eigen::Vector3d force_at(const Sample& here, const Sample& neighbour, double depth);

}  // namespace palpate::solve
