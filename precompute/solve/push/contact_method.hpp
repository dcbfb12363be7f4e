// SPDX-License-Identifier: GPL-3.0-or-later
// How a push keeps its tool out of the body.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::solve {

class Push;
struct StepResult;

/// How the tool is kept out of the body: by a penalty whose give is taken off the depth, by multipliers
/// (augmented.hpp), by a log barrier (barrier.hpp).
enum class ContactMethod { penalty, augmented, barrier };

/// Normal penalty in E / a: `penalty`, or a soft one for multipliers, which make up for it and are easier to solve
/// with.
inline double normal_penalty(ContactMethod method, double penalty) {
  return method == ContactMethod::augmented ? 30.0 : penalty;
}

/// Push::move_to by `method`, to a push of `depth` (m).
StepResult move_by(ContactMethod method, Push& push, const Eigen::Vector3d& target, double depth, double contact_radius,
                   double work_scale, bool sticking, const std::vector<Eigen::VectorXd>& starts = {});

}  // namespace palpate::solve
