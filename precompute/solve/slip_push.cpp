// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/slip_push.hpp"

#include "precompute/solve/gates.hpp"

#include <algorithm>

namespace palpate {
namespace {

using Eigen::Vector3d;

// The sample, or the cause of its refusal in `cause`.
Sample take(const Push& push, const CoulombPush& slip, const ContactFrame& frame, const SlipPush& plan,
            const Vector3d& base, double reach, std::uint32_t iterations, std::string& cause) {
  const FrictionReport friction = slip.friction();
  Sample s = plan.sample(iterations);
  s.kind = SampleKind::slipping;
  s.force += frame.to_local(friction.force);
  s.min_jacobian = push.min_jacobian();
  const double pull = (slip.force() - base).dot(plan.direction);
  GateState gate;
  gate.depth = plan.depth;
  gate.contact_radius = plan.contact_radius;
  gate.force = s.force.z();
  gate.work = slip.work();
  gate.stored = slip.stored();
  gate.energy_scale = plan.work_scale;
  gate.min_jacobian = s.min_jacobian;
  gate.contact = push.report();
  if (const auto failed = failed_slip_gate(gate, pull, slip.dissipated(), GateLimits{})) {
    cause = *failed;
    return s;
  }
  if (friction.gross()) s.friction_limit = s.force.head<2>().norm() / s.force.z();
  const double give = 2 * friction.stored / -pull;
  s.deflection =
      frame.to_local((reach - std::min(give, 0.1 * reach)) * plan.direction) + Vector3d(0, 0, plan.corrected_depth);
  return s;
}

}  // namespace

SlipPushResult slip_push(Push& push, const ContactFrame& frame, const SlipPush& plan) {
  SlipPushResult result;
  push.restore(plan.from);
  CoulombPush slip(push, plan.friction);
  const Vector3d start = plan.from.translation;
  Vector3d base = Vector3d::Zero();
  for (int k = 0; k <= plan.points; ++k) {
    const double reach = plan.reach * k / plan.points;
    const StepResult step = slip.move_to(start + reach * plan.direction, plan.contact_radius, plan.work_scale);
    ++result.solves;
    if (!step.converged) result.cause = step.cause;
    if (step.converged && k == 0) {
      base = slip.force();
      slip.open_account();
      continue;
    }
    if (step.converged) {
      const Sample sample = take(push, slip, frame, plan, base, reach, step.iterations, result.cause);
      if (result.cause.empty()) result.samples.push_back(sample);
    }
    if (!result.cause.empty()) {
      result.cause += " in the slipping push of " + std::to_string(1e3 * reach) + " mm sideways at depth " +
                      std::to_string(1e3 * plan.depth) + " mm";
      break;
    }
  }
  return result;
}

double gross_slip_reach(double friction, double poisson) { return friction * (2 - poisson) / (2 * (1 - poisson)); }

}  // namespace palpate
