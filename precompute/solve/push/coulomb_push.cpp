// SPDX-License-Identifier: GPL-3.0-or-later
// Fixed point over the normal pressures: each round is one minimisation with the limits of the last.
#include "precompute/solve/push/coulomb_push.hpp"

#include <algorithm>
#include <cstdio>

namespace palpate::solve {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

Isometry3d between(const Isometry3d& from, const Isometry3d& to, double share) {
  Isometry3d pose = to;
  if (share < 1) {
    pose.translation() = from.translation() + share * (to.translation() - from.translation());
    pose.linear() = Eigen::Quaterniond(from.linear()).slerp(share, Eigen::Quaterniond(to.linear())).toRotationMatrix();
  }
  return pose;
}

}  // namespace

CoulombPush::CoulombPush(Push& push, const CoulombOptions& options)
    : push_(push), options_(options), friction_(push.contact(), options.coefficient, options.stiffness) {
  PushState state = push.state();
  std::vector<FrictionEnergy::Anchor> anchors;
  for (std::size_t k = 0; k < state.anchors.held.size(); ++k) {
    ContactEnergy::Hold& held = state.anchors.held[k];
    if (held != ContactEnergy::Hold::none) anchors.push_back({k, state.anchors.position[k], 0.0});
    held = ContactEnergy::Hold::none;
  }
  friction_.set_anchors(std::move(anchors));
  push.restore(state);
  friction_.begin(state.x);
  push.add(friction_);
  open_account();
}

double CoulombPush::energy() const { return push_.elastic_energy() + push_.report().normal_energy + friction().stored; }

void CoulombPush::open_account() {
  work_ = dissipated_ = 0.0;
  opening_ = energy();
}

StepResult CoulombPush::step(const Isometry3d& target, double contact_radius, double work_scale) {
  StepResult result;
  const PushState before = push_.state();
  const Isometry3d from = push_.contact().pose();
  const std::vector<FrictionEnergy::Anchor> anchors = friction_.anchors();
  const Vector3d force = this->force(), moment = this->moment(from.translation());
  friction_.begin(before.x);

  std::vector<VectorXd> starts;
  const Vector3d last = before.translation - previous_translation_, next = target.translation() - before.translation;
  if (previous_x_.size() > 0 && last.dot(next) > 0) {
    starts.emplace_back(before.x + std::min(next.dot(last) / last.squaredNorm(), 2.0) * (before.x - previous_x_));
  }
  push_.set_rotation(target.linear());
  double share = 1.0, last_mismatch = 1.0;
  for (int round = 0; round < options_.rounds && !result.converged; ++round) {
    const StepResult s = push_.move_to(target.translation(), contact_radius, work_scale, false, starts);
    starts.clear();
    result.iterations += s.iterations;
    result.cause = s.cause;
    if (!s.converged) break;
    const FrictionEnergy::Mismatch now = friction_.mismatch(push_.state().x);
    if (now.points <= options_.agreement && now.sum <= options_.sum_agreement) {
      result.converged = true;
      break;
    }
    if (round > 1 && now.points > last_mismatch) share = std::max(0.25, share / 2);
    last_mismatch = now.points;
    friction_.hold(push_.state().x, share);
    char text[96];
    std::snprintf(text, sizeof text, "friction: limits and pressures differ by %.3g, allowed %.3g", now.points,
                  options_.agreement);
    result.cause = text;
  }
  if (!result.converged) {
    push_.set_rotation(from.linear());
    push_.restore(before);
    friction_.set_anchors(anchors);
    friction_.begin(before.x);
    return result;
  }
  dissipated_ += friction_.settle(push_.state().x);
  // The moments are of the tool's origin, so that they go with the turn alone.
  const Eigen::AngleAxisd turn(target.linear() * from.linear().transpose());
  work_ -= 0.5 * (force + this->force()).dot(next) +
           0.5 * (moment + this->moment(target.translation())).dot(turn.angle() * turn.axis());
  previous_x_ = before.x;
  previous_translation_ = before.translation;
  return result;
}

StepResult CoulombPush::move_to(const Isometry3d& target, double contact_radius, double work_scale) {
  const Isometry3d start = push_.contact().pose();
  return substep(
      [&](double to, double /*part*/) { return step(between(start, target, to), contact_radius, work_scale); });
}

StepResult CoulombPush::move_to(const Vector3d& target, double contact_radius, double work_scale) {
  Isometry3d pose = push_.contact().pose();
  pose.translation() = target;
  return move_to(pose, contact_radius, work_scale);
}

void CoulombPush::let_go(const Vector3d& target) {
  const double left = energy();
  const double returned = std::min(0.5 * force().dot(target - push_.state().translation), left);
  work_ -= returned;
  dissipated_ += left - returned;
  push_.let_go(target);
  friction_.set_anchors({});
  friction_.begin(push_.state().x);
  previous_x_.resize(0);
}

double gross_slip_reach(double friction, double poisson) { return friction * (2 - poisson) / (2 * (1 - poisson)); }

}  // namespace palpate::solve
