// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/push/barrier.hpp"

#include <algorithm>
#include <string>

namespace palpate::solve {

StepResult move_by_barrier(Push& push, const Eigen::Vector3d& target, double contact_radius, double work_scale,
                           bool sticking, const std::vector<Eigen::VectorXd>& starts, const BarrierOptions& options) {
  constexpr int kFloors = 8;
  double thickness = options.first * contact_radius, floor = options.floor * thickness;
  const double last = options.last * contact_radius;
  StepResult total;
  const auto solve = [&](const std::vector<Eigen::VectorXd>& from) {
    push.set_barrier(thickness, floor);
    const StepResult step = push.move_to(target, contact_radius, work_scale, sticking, from);
    total.iterations += step.iterations;
    total.energy_error = step.energy_error;
    total.converged = step.converged;
    total.cause = step.cause;
    return step.converged;
  };
  if (!solve(starts)) return total;
  while (thickness > last) {
    thickness = std::max(last, thickness / options.factor);
    floor = options.floor * thickness;
    if (!solve({})) return total;
  }
  // A floor lets a point through where the pressure is high.
  for (int k = 0; push.report().penetration > 0; ++k) {
    if (k == kFloors) {
      total.converged = false;
      total.cause = "log barrier: a point overlaps by " + std::to_string(1e3 * push.report().penetration) + " mm";
      break;
    }
    floor /= 4;
    if (!solve({})) return total;
  }
  return total;
}

}  // namespace palpate::solve
