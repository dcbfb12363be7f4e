// SPDX-License-Identifier: GPL-3.0-or-later
// Tangential pushes with Coulomb friction: partial slip from the rim inwards, then gross slip, both solved.
#include "precompute/solve/contact/gates.hpp"
#include "precompute/solve/pair/pair_run.hpp"
#include "precompute/solve/push/coulomb_push.hpp"

#include <algorithm>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;

class SlippingPush {
public:
  // From a point of the normal indentation towards `direction` (contact frame). The force of a contact that stuck while
  // it was pushed is first brought within the limit of every point.
  SlippingPush(PairRun& run, const CurvePoint& from, const Vector3d& direction)
      : run_(run), from_(from), direction_(direction), radius_(run.radius(from.depth)) {}

  // Appends its samples, indices from `index` on. Returns why samples are missing; else empty.
  std::string solve(std::uint16_t index) {
    run_.push.restore(from_.state);
    CoulombOptions friction;
    friction.coefficient = run_.path.friction;
    friction.stiffness = from_.state.penalty;
    CoulombPush slip(run_.push, friction);
    std::string cause;
    for (int k = 0; k <= run_.path.slip_points; ++k) {
      const double reach = run_.path.slip_reach * from_.depth * k / run_.path.slip_points;
      const StepResult step = slip.move_to(from_.state.translation + reach * run_.frame.to_world(direction_), radius_,
                                           run_.work_scale(from_.depth));
      ++run_.result.outcome.tangential_solves;
      cause = step.cause;
      if (step.converged && k == 0) {
        base_ = run_.frame.to_local(slip.force());
        base_stored_ = slip.friction().stored;
        slip.open_account();
      } else if (step.converged) {
        cause = take(slip, reach, step.iterations, static_cast<std::uint16_t>(index + k - 1));
      }
      if (cause.empty()) continue;
      return cause + " in the slipping push of " + std::to_string(1e3 * reach) + " mm at depth " +
             std::to_string(1e3 * from_.depth) + " mm";
    }
    return {};
  }

private:
  // The failed gate, or nothing when the sample was taken: its deflection is less the elastic slip's own give, and it
  // has the friction limit where every point slips.
  std::string take(const CoulombPush& slip, double reach, std::uint32_t iterations, std::uint16_t index) {
    const FrictionReport friction = slip.friction();
    Sample s = run_.sample(iterations);
    s.kind = SampleKind::slipping;
    s.index = index;
    s.force += run_.frame.to_local(friction.force);
    const double pull = (s.force - base_).dot(direction_);
    GateState gate;
    gate.depth = from_.depth;
    gate.contact_radius = radius_;
    gate.force = s.force.z();
    gate.work = slip.work();
    gate.stored = slip.stored();
    gate.energy_scale = run_.work_scale(from_.depth);
    gate.min_jacobian = s.min_jacobian;
    gate.contact = run_.push.report();
    if (const auto failed = failed_slip_gate(gate, pull, slip.dissipated(), GateLimits{})) return *failed;
    if (friction.gross()) s.friction_limit = s.force.head<2>().norm() / s.force.z();
    const double give = 2 * std::max(friction.stored - base_stored_, 0.0) / -pull;
    s.deflection =
        (reach - std::min(give, 0.1 * reach)) * direction_ + Vector3d(0, 0, run_.sample_of(from_).deflection.z());
    s.error_estimate = run_.sample_of(from_).error_estimate;
    run_.result.samples.push_back(s);
    return {};
  }

  PairRun& run_;
  const CurvePoint& from_;
  const Vector3d direction_;
  const double radius_;
  Vector3d base_{0, 0, 0};    // N, where the push began
  double base_stored_ = 0.0;  // J, there in the elastic slip
};

}  // namespace

void slipping_pushes(PairRun& run) {
  const PairPath& path = run.path;
  if (path.slip_points == 0) return;
  if (run.options.method != ContactMethod::penalty) {
    run.result.outcome.cause = "stopped short: slip is solved with a penalty alone";
    return;
  }
  const int directions = path.slip_directions > 0 ? path.slip_directions : path.tangential_directions;
  std::uint16_t index = 0;
  for (const double wanted : path.tangential_depths) {
    for (int d = 0; d < directions; ++d) {
      const std::string cause = SlippingPush(run, run.point_from(wanted), run.direction(d, directions)).solve(index);
      if (!cause.empty()) run.result.outcome.cause = "stopped short: " + cause;
      index = static_cast<std::uint16_t>(index + path.slip_points);
    }
  }
}

}  // namespace palpate::solve
