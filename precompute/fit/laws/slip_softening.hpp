// SPDX-License-Identifier: GPL-3.0-or-later
// The share of its normal force that a contact loses once all of it slips.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "formats/journal/samples.hpp"

namespace palpate::fit {

/// Force (x, y, n; N) of a contact that sticks, at a deflection (x, y tangential, depth; m).
using StickingForce = std::function<Eigen::Vector3d(const Eigen::Vector3d& deflection)>;

/// k of f_n = F (1 - k r z / Z), with r = 1 at gross slip: k z / Z is the share of F by which pushes that slip as a whole (samples of kind
/// slipping) have less normal force than a contact that sticks with the same tangential force at the same depth. It is
/// fitted over all depths, and clamped to [0, layout::kMaxSoftening] and to 1.5 times the value of the deepest pushes,
/// because shallow contacts span few elements. `depth_scale`: Z (m). A sliding tool comes to tissue of other stiffness: the fit separates and
/// removes the parts that grow with the displacement and with its square. Returns 0 when the deepest pushes are fewer
/// than four, do not span three directions, or change their force by more than a quarter, as at a margin.
double slip_softening(const std::vector<Sample>& samples, const StickingForce& sticking,
                      double depth_scale);

}  // namespace palpate::fit
