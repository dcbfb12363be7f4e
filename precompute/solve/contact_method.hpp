// SPDX-License-Identifier: GPL-3.0-or-later
// How a push keeps its tool out of the body.
#pragma once

#include "precompute/solve/pair.hpp"
#include "precompute/solve/push.hpp"

namespace palpate {

/// Normal penalty in E / a: multipliers make up for a soft one, which is easier to solve with.
inline double normal_penalty(const PairOptions& options) {
  return options.method == ContactMethod::augmented ? 30.0 : options.penalty;
}

/// Push::move_to by options.method, to a push of `depth` (m).
StepResult move_by(const PairOptions& options, Push& push, const Eigen::Vector3d& target, double depth,
                   double contact_radius, double work_scale, bool sticking,
                   const std::vector<Eigen::VectorXd>& starts = {});

}  // namespace palpate
