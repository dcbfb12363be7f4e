// SPDX-License-Identifier: GPL-3.0-or-later
// Stepping with extrapolation, halving on failure, and the sticking rule.
#include "precompute/solve/push/push.hpp"

#include "precompute/solve/contact/letting_go.hpp"
#include "precompute/solve/contact/surface_offsets.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::solve {
namespace {

// Searches of one step while contact points let go, and the tolerances of those before the last.
constexpr int kRounds = 30;
constexpr double kRoughEnergy = 100, kRoughResidual = 10;

}  // namespace

using Eigen::Vector3d;
using Eigen::VectorXd;

Push::Push(const Body& body, const mesh::TetMesh& mesh, const tool::ToolShape& shape, const Eigen::Isometry3d& pose,
           const PushScale& scale, const std::vector<fem::Material>& given)
    : scale_(scale),
      body_(body, mesh, given),
      untouched_(body_.rest()),
      contact_(mesh, body_.fixed(), shape, pose, surface_offsets(mesh, *body.query)),
      minimiser_(mesh, body_.fixed(), scale.limits) {
  state_.x = untouched_;
  state_.anchors = contact_.anchors();
  state_.translation = pose.translation();
}

Settled Push::settle(double energy_tolerance) {
  const Settled settled = solve::settle(body_, minimiser_, state_.x, energy_tolerance);
  factorisations_ += settled.factorisations;
  untouched_ = state_.x;
  settled_energy_ = body_.value(untouched_);
  return settled;
}

double Push::value(const VectorXd& x) const {
  double sum = body_.value(x) + contact_.value(x);
  for (const EnergyTerm* term : terms_) sum += term->value(x);
  return sum;
}

double Push::gradient(const VectorXd& x, VectorXd& gradient) const {
  double sum = body_.gradient(x, gradient) + contact_.gradient(x, gradient);
  for (const EnergyTerm* term : terms_) sum += term->gradient(x, gradient);
  return sum;
}

void Push::hessian(const VectorXd& x, fem::HessianKind kind, fem::BlockMatrix& matrix) const {
  body_.hessian(x, kind, matrix);
  contact_.hessian(x, kind, matrix);
  for (const EnergyTerm* term : terms_) term->hessian(x, kind, matrix);
}

double Push::load(const VectorXd& x) const {
  VectorXd nodal = VectorXd::Zero(x.size());
  contact_.gradient(x, nodal);
  return std::max(nodal.norm(), load_floor_);
}

double Push::rest_gap(const Vector3d& translation) {
  contact_.set_translation(translation);
  const double gap = contact_.gap(untouched_);
  contact_.set_translation(state_.translation);
  return gap;
}

void Push::restore(const PushState& state) {
  state_ = state;
  contact_.set_translation(state.translation);
  contact_.set_anchors(state.anchors);
  contact_.set_penalty(state.penalty);
  contact_.set_multipliers(state.multipliers);
  can_extrapolate_ = false;
}

void Push::let_go(const Vector3d& translation) {
  PushState free = state_;
  free.x = untouched_;
  free.anchors = {};
  free.translation = translation;
  restore(free);
}

void Push::stick() {
  contact_.stick(state_.x);
  state_.anchors = contact_.anchors();
}

void Push::bond() {
  contact_.bond(state_.x);
  state_.anchors = contact_.anchors();
}

void Push::augment() {
  contact_.augment(state_.x);
  state_.multipliers = contact_.multipliers();
}

VectorXd Push::best_start(const Vector3d& target, const std::vector<VectorXd>& starts) const {
  VectorXd x = state_.x;
  double least = value(x);
  const auto consider = [&](const VectorXd& start) {
    const double energy = value(start);
    if (!(energy < least)) return;
    least = energy;
    x = start;
  };
  if (can_extrapolate_) {
    const Vector3d last = state_.translation - previous_translation_, next = target - state_.translation;
    const double ratio = last.squaredNorm() > 0 ? next.dot(last) / last.squaredNorm() : 0.0;
    consider(state_.x + std::clamp(ratio, 0.0, 4.0) * (state_.x - previous_x_));
  }
  for (const VectorXd& start : starts) consider(start);
  return x;
}

StepResult Push::step(const Vector3d& target, double contact_radius, double work_scale, bool sticking,
                      const std::vector<VectorXd>& starts) {
  StepResult result;
  const PushState before = state_;
  std::vector<ContactEnergy::Anchors> others;
  for (const ContactEnergy* other : others_) others.push_back(other->anchors());
  contact_.set_translation(target);
  state_.penalty = scale_.penalty * scale_.young / contact_radius;
  contact_.set_penalty(state_.penalty);
  VectorXd x = best_start(target, starts);
  fem::MinimiserOptions options;
  // A tool between integration points meets no load: residuals are then compared with a small one.
  load_floor_ = 0.1 * work_scale / contact_radius;
  options.energy_tolerance = scale_.tolerance * scale_.tolerance * work_scale;
  // Which points let go shows long before equilibrium: none is found to the end for anchors that then leave.
  fem::MinimiserOptions rough = options;
  rough.energy_tolerance *= kRoughEnergy;
  rough.residual_tolerance *= kRoughResidual;
  const std::uint32_t factorisations_before = factorisations_;
  bool settling = sticking;
  const std::size_t stuck = contact_.stuck();
  LettingGo letting_go(stuck);
  for (int round = 0; round < kRounds; ++round) {
    const fem::MinimiserResult m = minimiser_.minimise(*this, x, settling ? rough : options);
    result.iterations += m.iterations;
    factorisations_ += m.factorisations;
    result.energy_error = 0.5 * m.decrement;
    result.converged = m.converged;
    result.cause = m.cause;
    if (!m.converged) break;
    // A point that left takes its anchor's energy with it: the equilibrium without it is still to be found.
    bool left = sticking && contact_.release(x);
    for (ContactEnergy* other : others_) left = (sticking && other->release(x)) || left;
    if (!left && !settling) break;
    if (letting_go.peels(contact_.stuck(), kRounds - 1 - round)) {
      result.converged = false;
      result.peels = true;
      result.cause = "the contact peels: " + std::to_string(contact_.stuck()) + " of " + std::to_string(stuck) +
                     " points still stick, and they keep letting go";
      break;
    }
    settling = settling && left;
    result.converged = false;
    result.cause = "contact points keep letting go";
  }
  if (!result.converged) {
    lost_factorisations_ += factorisations_ - factorisations_before;
    restore(before);
    for (std::size_t k = 0; k < others_.size(); ++k) others_[k]->set_anchors(others[k]);
    minimiser_.drop_factor();
    return result;
  }
  if (sticking) {
    contact_.stick(x);
    for (ContactEnergy* other : others_) other->stick(x);
  }
  previous_x_ = before.x;
  previous_translation_ = before.translation;
  can_extrapolate_ = true;
  state_.x = std::move(x);
  state_.anchors = contact_.anchors();
  state_.translation = target;
  return result;
}

StepResult Push::move_to(const Vector3d& target, double contact_radius, double work_scale, bool sticking,
                         const std::vector<VectorXd>& starts) {
  const Vector3d start = state_.translation;
  return substep([&](double to, double part) {
    return step(start + to * (target - start), contact_radius, work_scale, sticking,
                part == 1.0 ? starts : std::vector<VectorXd>{});
  });
}

}  // namespace palpate::solve
