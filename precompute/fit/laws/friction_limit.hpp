// SPDX-License-Identifier: GPL-3.0-or-later
// The friction coefficient of a pair over its depth: as solved where slipping pushes were, else as predicted.
#pragma once

#include <utility>
#include <vector>

#include "formats/journal/samples.hpp"

namespace palpate::fit {

/// Depth (m) and mu(depth) of every normal sample, in the order of the samples. mu is the tangential force that
/// friction holds at gross slip over the normal force of the slipping contact, which is F (1 - k) with the slip
/// softening k. The value that the slopes of the normal curve predict is multiplied by the ratio of solved to
/// predicted: 1 at depth 0, where both are Coulomb's coefficient, the mean over directions at depths with pushes that
/// slip as a whole (only the farthest of them), linear between these depths, constant beyond the deepest. If a contact
/// was drawn as far and still stuck in part, mu is at least its force ratio. Without slipping samples mu is the
/// predicted one. `depth_scale`: Z (m).
std::vector<std::pair<double, double>> friction_limits(const std::vector<Sample>& samples, double depth_scale);

}  // namespace palpate::fit
