// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/pair/pair_run.hpp"

#include "precompute/solve/push/contact_method.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::solve {

WayEnergy::WayEnergy(const Push& push)
    : push_(push), start_(energy()), at_(push.state().translation), force_(push.report().force) {}

void WayEnergy::moved() {
  const Eigen::Vector3d at = push_.state().translation, force = push_.report().force;
  work_ -= 0.5 * (force_ + force).dot(at - at_);
  at_ = at;
  force_ = force;
}

double WayEnergy::energy() const {
  const ContactReport r = push_.report();
  return push_.elastic_energy() + r.normal_energy + r.tangential_energy;
}

bool PairRun::refuse(const std::string& cause) {
  result.outcome.accepted = false;
  result.outcome.cause = cause;
  result.samples.clear();
  return false;
}

bool PairRun::stop_short(const std::string& cause, bool nothing_yet, bool peels) {
  if (!peels && nothing_yet) return refuse_contact(cause);
  result.outcome.cause = "stopped short: " + cause;
  return true;
}

double PairRun::work_scale(double depth) const { return body.material.young * radius(depth) * depth * depth; }

StepResult PairRun::move_to(const Eigen::Vector3d& target, double depth, bool sticking,
                            const std::vector<Eigen::VectorXd>& starts) const {
  return move_by(options.method, push, target, depth, radius(depth), work_scale(depth), sticking, starts);
}

Sample PairRun::sample(std::uint32_t iterations) const {
  const ContactReport r = push.report();
  Sample s;
  s.force = frame.to_local(r.force);
  // About the point of first touch, which has gone with the tool.
  const Eigen::Vector3d arm = push.contact().pose().linear() * vertex.point;
  s.torque = frame.to_local(r.moment - arm.cross(r.force));
  s.contact_area = r.area;
  s.penetration = r.penetration;
  s.min_jacobian = push.min_jacobian();
  s.contact_points = r.points;
  s.iterations = iterations;
  return s;
}

GateState PairRun::tangential_gate(double depth, const Sample& sample, const WayEnergy& way) const {
  GateState gate;
  gate.depth = depth;
  gate.contact_radius = radius(depth);
  gate.force = sample.force.z();
  gate.min_jacobian = sample.min_jacobian;
  gate.contact = push.report();
  gate.work = way.work();
  gate.stored = way.stored();
  gate.energy_scale = work_scale(depth);
  return gate;
}

const CurvePoint& PairRun::point_from(double depth) const {
  return *std::find_if(curve.begin(), curve.end(), [&](const CurvePoint& p) { return p.depth >= depth * (1 - 1e-9); });
}

Eigen::Vector3d PairRun::direction(int k, int count) const {
  const double angle = path.tangential_start + 2 * std::numbers::pi * k / count;
  return {std::cos(angle), std::sin(angle), 0.0};
}

}  // namespace palpate::solve
