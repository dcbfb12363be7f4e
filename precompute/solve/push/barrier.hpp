// SPDX-License-Identifier: GPL-3.0-or-later
// A log barrier in the penalty's place: no integration point of the surface overlaps the tool.
#pragma once

#include "precompute/solve/push/push.hpp"

namespace palpate::solve {

struct BarrierOptions {
  double first = 0.1;   ///< thickness in which the search begins, in contact radii ...
  double last = 1e-3;   ///< ... and that of the result
  double factor = 2.5;  ///< between two thicknesses: the old gaps lie within the new one
  double floor = 0.05;  ///< of the thickness, see ContactLaw
};

/// Push::move_to with a thick barrier, which then is made thinner (an interior-point method: every minimum starts the
/// search for the next). Afterwards the push keeps the thin barrier.
StepResult move_by_barrier(Push& push, const Eigen::Vector3d& target, double contact_radius, double work_scale,
                           bool sticking, const std::vector<Eigen::VectorXd>& starts = {},
                           const BarrierOptions& options = {});

}  // namespace palpate::solve
