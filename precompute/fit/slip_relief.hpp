// SPDX-License-Identifier: GPL-3.0-or-later
// How much less a contact pushes where all of it slips than where it sticks (palpate/relief.hpp).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "formats/samples.hpp"

namespace palpate::fit {

/// Force (x, y, n; N) of a contact that sticks, at a deflection (x, y sideways, depth; m).
using StickingForce = std::function<Eigen::Vector3d(const Eigen::Vector3d& deflection)>;

/// k of BasicRelief, at least 0 and below 0.2, from slipping pushes (samples of kind slipping) and what `sticking` says
/// at the deflection that friction held: the shortfall of their normal forces, by least squares over all depths. A tool
/// that slides comes to where the body answers otherwise: what grows with the way, by direction or with its square, is
/// told apart and left out. 0 without at least four such pushes of a depth, in three directions, and where the deepest
/// lost or won more than a quarter of their force, as at a margin, that the tool slides off. `scale`: Z (m).
double slip_relief(const std::vector<Sample>& samples, const StickingForce& sticking, double scale);

}  // namespace palpate::fit
