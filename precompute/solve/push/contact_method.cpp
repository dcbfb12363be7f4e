// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/push/contact_method.hpp"

#include "precompute/solve/push/augmented.hpp"
#include "precompute/solve/push/barrier.hpp"

namespace palpate::solve {

StepResult move_by(ContactMethod method, Push& push, const Eigen::Vector3d& target, double depth, double contact_radius,
                   double work_scale, bool sticking, const std::vector<Eigen::VectorXd>& starts) {
  switch (method) {
    case ContactMethod::augmented:
      return move_augmented(push, target, depth, contact_radius, work_scale, sticking, starts);
    case ContactMethod::barrier:
      return move_by_barrier(push, target, contact_radius, work_scale, sticking, starts);
    case ContactMethod::penalty:
      break;
  }
  return push.move_to(target, contact_radius, work_scale, sticking, starts);
}

}  // namespace palpate::solve
