// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/push/augmented.hpp"

#include <cmath>
#include <cstdio>

namespace palpate::solve {

StepResult move_augmented(Push& push, const Eigen::Vector3d& target, double depth, double contact_radius,
                          double work_scale, bool sticking, const std::vector<Eigen::VectorXd>& starts,
                          const AugmentedOptions& options) {
  StepResult total = push.move_to(target, contact_radius, work_scale, sticking, starts);
  double last = push.report().force.norm();
  for (int round = 0; total.converged; ++round) {
    push.augment();
    const StepResult step = push.move_to(target, contact_radius, work_scale, sticking);
    total.iterations += step.iterations;
    total.energy_error = step.energy_error;
    total.converged = step.converged;
    total.cause = step.cause;
    if (!step.converged) break;
    const ContactReport now = push.report();
    const double force = now.force.norm();
    // A tool that touches nothing has nothing to take off.
    const double give = force > 0 ? 2 * std::abs(now.normal_energy) / force / depth : 0.0;
    const double change = force > 0 ? std::abs(force - last) / force : 0.0;
    if (give <= options.give && change <= options.change) break;
    last = force;
    if (round + 1 < options.rounds) continue;
    total.converged = false;
    char text[128];
    std::snprintf(text, sizeof text,
                  "augmented Lagrange: after %d rounds the overlap is %.3g of the depth, the force changes by %.3g",
                  options.rounds, give, change);
    total.cause = text;
  }
  return total;
}

}  // namespace palpate::solve
