// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/pair/bonded.hpp"

#include "precompute/solve/contact/gates.hpp"
#include "precompute/solve/pair/error_estimate.hpp"
#include "precompute/solve/push/contact_method.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::solve {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Bonded::Bonded(PairRun& run, const CurvePoint& at, double furthest)
    : run_(run), at_(at), radius_(run.radius(at.depth)), scale_(run.work_scale(std::max(at.depth, furthest))) {
  run_.push.restore(at_.state);
  run_.push.bond();
  rest_ = run_.push.contact().pose().linear();
  stored_ = stored();
  start_ = stand({});
}

void Bonded::restore(const Stand& stand) {
  run_.push.set_rotation(rotation(stand.turned));
  run_.push.restore(stand.state);
}

double Bonded::contact_energy() const {
  const ContactReport r = run_.push.report();
  return r.normal_energy + r.tangential_energy;
}

Matrix3d Bonded::rotation(const Vector3d& turned) const {
  const double angle = turned.norm();
  if (!(angle > 0)) return rest_;
  return Eigen::AngleAxisd(angle, run_.frame.to_world(turned / angle)) * rest_;
}

// The state of the push. The bonded surface has moved like the tool's point of first touch, minus the elongation of the
// bond itself.
Bonded::Stand Bonded::stand(const StepResult& step) const {
  Stand s{run_.push.state(), run_.sample(step.iterations)};
  s.force = run_.frame.to_world(s.sample.force);
  s.contact_energy = contact_energy();
  s.sample.kind = SampleKind::grasped;
  const Vector3d& point = run_.vertex.point;
  const Vector3d way = run_.push.contact().pose() * point - (run_.start + rest_ * point);
  const Vector3d moved = run_.frame.to_local(way + run_.push.report().bond_give);
  s.sample.deflection = {moved.x(), moved.y(), -moved.z()};
  s.sample.error_estimate = run_.sample_of(at_).error_estimate;
  return s;
}

// A pull passes through no force: errors are of the larger of its own and that of the bond.
void Bonded::add_error(Stand& s, double way, double give, const StepResult& step) const {
  s.sample.error_estimate +=
      error_estimate({std::max(s.force.norm(), at_.contact.force.norm()), way, give, step.energy_error,
                      s.state.penalty * s.sample.contact_area, s.sample.contact_points});
}

std::optional<std::string> Bonded::take(Stand& now, Stand&& next, double work, double answer) const {
  next.work = now.work + work;
  next.effort = now.effort + std::abs(work);
  GateState gate;
  gate.depth = next.sample.deflection.z();
  gate.contact_radius = radius_;
  gate.force = next.sample.force.z();
  gate.work = next.effort;
  gate.stored = next.effort + stored() - stored_ - next.work;
  gate.energy_scale = scale_;
  gate.min_jacobian = next.sample.min_jacobian;
  gate.contact = run_.push.report();
  if (auto failed = failed_grasp_gate(gate, answer, GateLimits{})) return failed;
  now = std::move(next);
  return std::nullopt;
}

std::optional<std::string> Bonded::move(Stand& now, const Vector3d& target) {
  const Vector3d way = target - now.state.translation;
  const StepResult step =
      move_by(run_.options.method, run_.push, target, at_.depth, radius_, scale_, run_.path.friction > 0);
  ++run_.result.outcome.tangential_solves;
  if (!step.converged) return step.cause;
  Stand next = stand(step);
  next.turned = now.turned;
  next.sample.rotation = now.sample.rotation;
  add_error(next, (next.state.translation - at_.state.translation).norm(), run_.push.report().bond_give.norm(), step);
  const double work = -0.5 * (now.force + next.force).dot(way), answer = (next.force - now.force).dot(way);
  return take(now, std::move(next), work, answer);
}

std::optional<std::string> Bonded::turn(Stand& now, const Stand& from, const Vector3d& target) {
  const Vector3d start = now.turned, way = target - start;
  const Vector3d rests = run_.push.contact().pose() * run_.vertex.point;
  Vector3d reached = start;
  const StepResult step = substep([&](double to, double /*part*/) {
    const PushState before = run_.push.state();
    const Vector3d next = start + to * way;
    const Matrix3d turned = rotation(next);
    run_.push.set_rotation(turned);
    const StepResult s = move_by(run_.options.method, run_.push, rests - turned * run_.vertex.point, at_.depth, radius_,
                                 scale_, run_.path.friction > 0);
    if (s.converged) {
      reached = next;
    } else {
      run_.push.set_rotation(rotation(reached));
      run_.push.restore(before);
    }
    return s;
  });
  ++run_.result.outcome.tangential_solves;
  if (!step.converged) return step.cause;
  Stand next = stand(step);
  next.turned = target;
  const double work = -0.5 * (now.sample.torque + next.sample.torque).dot(way),
               answer = (next.sample.torque - now.sample.torque).dot(way);
  // The contact's own compliance, at a constant contact area: twice its energy over the torque.
  const double angle = target.norm(), against = -(next.sample.torque - from.sample.torque).dot(target) / angle;
  const double give = against > 0 ? 2 * (next.contact_energy - from.contact_energy) / against : 0.0;
  next.sample.rotation = (1 - std::clamp(give / angle, 0.0, 0.1)) * target;
  add_error(next, radius_ * angle, radius_ * give, step);
  return take(now, std::move(next), work, answer);
}

}  // namespace palpate::solve
