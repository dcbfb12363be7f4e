// SPDX-License-Identifier: GPL-3.0-or-later
// The friction limit of a pair over its depth: as solved where slipping pushes were, else as foretold.
#pragma once

#include <utility>
#include <vector>

#include "formats/samples.hpp"

namespace palpate::fit {

/// Depth (m) and mu(depth) of every straight push, in the order of the samples. What its slopes foretell is multiplied
/// by the ratio of solved to foretold: 1 at depth 0, where both are Coulomb's coefficient, the mean over directions at
/// depths from which the contact was drawn furthest while it slipped, linear between them, constant beyond the deepest.
/// Without such a sample it is what was foretold.
std::vector<std::pair<double, double>> friction_limits(const std::vector<Sample>& samples);

}  // namespace palpate::fit
