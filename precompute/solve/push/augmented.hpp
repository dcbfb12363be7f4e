// SPDX-License-Identifier: GPL-3.0-or-later
// Augmented Lagrange: a contact without the penalty's give, from a penalty that may be soft.
#pragma once

#include "precompute/solve/push/push.hpp"

namespace palpate::solve {

struct AugmentedOptions {
  double give = 5e-4;    ///< largest mean overlap that is left (by pressure), of the depth
  double change = 1e-3;  ///< largest relative change of the force in the last round
  int rounds = 30;       ///< minimisations after the first
};

/// Push::move_to, then Uzawa's rounds (e.g. Wriggers 2006, section 6.3.3): the pressures become multipliers and the
/// equilibrium is found anew, until pressures stand without an overlap. `depth` (m) of the push is what `give` is of.
StepResult move_augmented(Push& push, const Eigen::Vector3d& target, double depth, double contact_radius,
                          double work_scale, bool sticking, const std::vector<Eigen::VectorXd>& starts = {},
                          const AugmentedOptions& options = {});

}  // namespace palpate::solve
