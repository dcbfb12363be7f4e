// SPDX-License-Identifier: GPL-3.0-or-later
// The friction limit of a pair over its depth: as solved where slipping pushes were, else as foretold.
#pragma once

#include <utility>
#include <vector>

#include "formats/samples.hpp"

namespace palpate::fit {

/// Depth (m) and mu(depth) of every straight push, in the order of the samples, both as the runtime counts them where
/// all of the contact slips and its responses' relief is `relief` (palpate/relief.hpp). What the slopes of a push
/// foretell is multiplied by the ratio of solved to foretold: 1 at depth 0, where both are Coulomb's coefficient, the
/// mean over directions at depths from which the contact was drawn furthest while it slipped, linear between them,
/// constant beyond the deepest. A contact that was drawn as far and still held in part holds as much at least. Without
/// such samples it is what was foretold. `scale`: Z (m).
std::vector<std::pair<double, double>> friction_limits(const std::vector<Sample>& samples, double scale,
                                                       double relief = 0);

}  // namespace palpate::fit
