// SPDX-License-Identifier: GPL-3.0-or-later
// Stepping with extrapolation, halving on failure, and the sticking rule.
#include "precompute/solve/push.hpp"

#include "precompute/fem/scene_material.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

std::vector<Material> materials(const Body& body) {
  std::vector<Material> all{make_material(body.material)};
  for (const Inclusion& i : body.inclusions) all.push_back(make_material(i.material));
  return all;
}

VectorXd stacked(const TetMesh& mesh) {
  VectorXd x(3 * static_cast<Eigen::Index>(mesh.nodes.size()));
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) x.segment<3>(3 * n) = mesh.nodes[n];
  return x;
}

}  // namespace

std::vector<char> fixed_nodes(const Body& body, const TetMesh& mesh) {
  std::vector<char> boundary(mesh.nodes.size(), 0), fixed(mesh.nodes.size(), 0);
  for (const auto& face : mesh.faces) {
    for (const std::int32_t n : face) boundary[n] = 1;
  }
  for (std::size_t n = 0; n < fixed.size(); ++n) {
    const SupportScene* support = boundary[n] ? body.support_at(mesh.nodes[n]) : nullptr;
    fixed[n] = support != nullptr && support->type == SupportScene::Type::fixed;
  }
  return fixed;
}

Push::Push(const Body& body, const TetMesh& mesh, const ToolShape& shape, const Eigen::Isometry3d& pose,
           const PushScale& scale, const std::vector<Material>& given)
    : scale_(scale),
      rest_(stacked(mesh)),
      fixed_(fixed_nodes(body, mesh)),
      elastic_(mesh, given.empty() ? materials(body) : given),
      membrane_(mesh, fixed_, {body.capsule_thickness, body.capsule_young}),
      bed_(body, mesh),
      contact_(mesh, fixed_, shape, pose),
      minimiser_(mesh, fixed_) {
  state_.x = rest_;
  state_.anchors = contact_.anchors();
  state_.translation = pose.translation();
  rest_energy_ = elastic_.value(rest_);
  held_anywhere_ = !bed_.empty() || std::any_of(fixed_.begin(), fixed_.end(), [](char f) { return f != 0; });
}

double Push::value(const VectorXd& x) const {
  double sum = elastic_.value(x) - rest_energy_ + membrane_.value(x) + bed_.value(x) + contact_.value(x);
  for (const EnergyTerm* term : terms_) sum += term->value(x);
  return sum;
}

double Push::gradient(const VectorXd& x, VectorXd& gradient) const {
  gradient.setZero();
  double sum = elastic_.gradient(x, gradient) - rest_energy_ + membrane_.gradient(x, gradient) +
               bed_.gradient(x, gradient) + contact_.gradient(x, gradient);
  for (const EnergyTerm* term : terms_) sum += term->gradient(x, gradient);
  return sum;
}

void Push::hessian(const VectorXd& x, HessianKind kind, BlockMatrix& matrix) const {
  elastic_.hessian(x, kind, matrix);
  membrane_.hessian(x, kind, matrix);
  bed_.hessian(matrix);
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
  const double gap = contact_.gap(rest_);
  contact_.set_translation(state_.translation);
  return gap;
}

void Push::restore(const PushState& state) {
  state_ = state;
  contact_.set_translation(state.translation);
  contact_.set_anchors(state.anchors);
  contact_.set_penalty(state.penalty);
  can_extrapolate_ = false;
}

void Push::stick() {
  contact_.stick(state_.x);
  state_.anchors = contact_.anchors();
}

StepResult Push::step(const Vector3d& target, double contact_radius, double work_scale, bool sticking,
                      const std::vector<VectorXd>& starts) {
  StepResult result;
  const PushState before = state_;
  contact_.set_translation(target);
  state_.penalty = scale_.penalty * scale_.young / contact_radius;
  contact_.set_penalty(state_.penalty);
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
  MinimiserOptions options;
  // A tool between integration points meets no load: residuals are then compared with a small one.
  load_floor_ = 0.1 * work_scale / contact_radius;
  options.energy_tolerance = scale_.tolerance * scale_.tolerance * work_scale;
  for (int round = 0; round < 20; ++round) {
    const MinimiserResult m = minimiser_.minimise(*this, x, options);
    result.iterations += m.iterations;
    factorisations_ += m.factorisations;
    result.converged = m.converged;
    result.cause = m.cause;
    if (!m.converged || !sticking || !contact_.release(x)) break;
    // A point that left takes its anchor's energy with it: the equilibrium without it is still to be found.
    result.converged = false;
    result.cause = "contact points keep letting go";
  }
  if (!result.converged) {
    restore(before);
    minimiser_.drop_factor();
    return result;
  }
  if (sticking) contact_.stick(x);
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
  StepResult total;
  double done = 0.0, part = 1.0;
  while (done < 1.0) {
    const double next = std::min(1.0, done + part);
    const StepResult s = step(start + next * (target - start), contact_radius, work_scale, sticking,
                              part == 1.0 ? starts : std::vector<VectorXd>{});
    total.iterations += s.iterations;
    total.cause = s.cause;
    if (s.converged) {
      done = next;
      continue;
    }
    part *= 0.5;
    if (part < 1.0 / 8) return total;
  }
  total.converged = true;
  return total;
}

}  // namespace palpate
