// SPDX-License-Identifier: GPL-3.0-or-later
// One tool against one mesh: moves the tool in steps and finds the equilibrium after each.
#pragma once

#include "precompute/common/body.hpp"
#include "precompute/fem/minimiser.hpp"
#include "precompute/solve/contact/body_energy.hpp"
#include "precompute/solve/contact/contact.hpp"
#include "precompute/solve/contact/settle.hpp"
#include "precompute/solve/contact/substepping.hpp"

#include <string>
#include <vector>

namespace palpate::solve {

/// Numbers that fix the scale of a push.
struct PushScale {
  double young = 0.0;       ///< Pa, of the body
  double penalty = 300.0;   ///< E / a
  double tolerance = 1e-3;  ///< relative energy tolerance is its square
  SolveLimits limits{};     ///< a step past its deadline finds no equilibrium
};

/// Equilibrium state and everything that a later push needs to go on from it.
struct PushState {
  Eigen::VectorXd x;  ///< node positions (3 N, m)
  ContactEnergy::Anchors anchors;
  Eigen::Vector3d translation{0, 0, 0};  ///< of the tool (m)
  double penalty = 0.0;                  ///< Pa/m
  std::vector<double> multipliers;       ///< Pa, of the contact
};

class Push final : public fem::EnergyProblem {
public:
  /// `body` is free of stress. The tool stands at `pose`. `materials` per region; empty: the body's. Throws as
  /// Minimiser.
  Push(const Body& body, const mesh::TetMesh& mesh, const tool::ToolShape& shape, const Eigen::Isometry3d& pose,
       const PushScale& scale, const std::vector<fem::Material>& materials = {});

  /// Lets the body's prestress act, before the tool is near; see settle().
  Settled settle(double energy_tolerance);

  /// Moves the tool's translation to `target` and finds equilibrium, in up to 2^3 parts where one step fails.
  /// `contact_radius` (m) sets the penalty, `work_scale` (J) the tolerance. With `sticking`, points anchor as
  /// they touch and let go as they leave. `starts` are guesses of the node positions at the target: the search
  /// begins at the one of least energy, if that is below where the body is.
  StepResult move_to(const Eigen::Vector3d& target, double contact_radius, double work_scale, bool sticking,
                     const std::vector<Eigen::VectorXd>& starts = {});

  [[nodiscard]] const PushState& state() const { return state_; }
  /// Goes back to a state of this mesh; the next step extrapolates from nothing.
  void restore(const PushState& state);
  /// The tool goes to where it does not reach the surface that nothing touches: the body is as before any contact.
  void let_go(const Eigen::Vector3d& translation);
  /// Turns the tool about its own origin; it stays turned, restore() or not.
  void set_rotation(const Eigen::Matrix3d& rotation) { contact_.set_rotation(rotation); }
  void set_anchor_stiffness(double stiffness) { contact_.set_anchor_stiffness(stiffness); }
  /// Anchors everything that touches now.
  void stick();
  /// Anchors everything that touches now for good, with bonds that also carry tension.
  void bond();
  /// Takes the pressures as multipliers, from the next step on (ContactEnergy::augment).
  void augment();
  /// Answers with a log barrier from the next step on (ContactEnergy::set_barrier); it stays, restore() or not.
  void set_barrier(double thickness, double floor) { contact_.set_barrier(thickness, floor); }
  /// A further part of the energy, from the next step on; it must outlive the push or be taken out before.
  void add(const EnergyTerm& term) { terms_.push_back(&term); }
  /// A further tool, which sticks as the first does. Its owner moves it.
  void add(ContactEnergy& other) {
    terms_.push_back(&other);
    others_.push_back(&other);
  }
  void remove(const EnergyTerm& term) { std::erase(terms_, &term); }

  [[nodiscard]] ContactReport report() const { return contact_.report(state_.x); }
  [[nodiscard]] const ContactEnergy& contact() const { return contact_; }
  /// J stored in the body, its capsule and elastic supports, less what its weight and pressure gave since it settled.
  [[nodiscard]] double elastic_energy() const { return body_.value(state_.x) - settled_energy_; }
  [[nodiscard]] double min_jacobian() const { return body_.min_jacobian(state_.x); }
  [[nodiscard]] std::uint32_t factorisations() const { return factorisations_; }
  /// The factorisations of steps that found no equilibrium.
  [[nodiscard]] std::uint32_t lost_factorisations() const { return lost_factorisations_; }
  [[nodiscard]] const std::vector<char>& fixed() const { return body_.fixed(); }  ///< per node
  [[nodiscard]] bool held_anywhere() const { return body_.held_anywhere(); }
  /// Smallest signed distance of the surface, before any contact, to the tool at a translation (m).
  [[nodiscard]] double rest_gap(const Eigen::Vector3d& translation);

  // EnergyProblem
  [[nodiscard]] double value(const Eigen::VectorXd& x) const override;
  double gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const override;
  void hessian(const Eigen::VectorXd& x, fem::HessianKind kind, fem::BlockMatrix& matrix) const override;
  [[nodiscard]] double load(const Eigen::VectorXd& x) const override;
  [[nodiscard]] fem::Rounding rounding() const override { return body_.rounding(); }

private:
  /// The node positions of least energy, with the tool at `target`: those of the state, its last step continued, or one
  /// of `starts`.
  [[nodiscard]] Eigen::VectorXd best_start(const Eigen::Vector3d& target,
                                           const std::vector<Eigen::VectorXd>& starts) const;
  StepResult step(const Eigen::Vector3d& target, double contact_radius, double work_scale, bool sticking,
                  const std::vector<Eigen::VectorXd>& starts);

  PushScale scale_;
  BodyEnergy body_;
  Eigen::VectorXd untouched_;  // node positions before any contact
  // J there. It is subtracted from reported energies, not from the minimised one: the line search derives the rounding
  // of energy differences from the size of the energies.
  double settled_energy_ = 0.0;
  ContactEnergy contact_;
  std::vector<const EnergyTerm*> terms_;
  std::vector<ContactEnergy*> others_;  // of terms_
  fem::Minimiser minimiser_;
  PushState state_;
  Eigen::VectorXd previous_x_;  // state before the last step, for extrapolation
  Eigen::Vector3d previous_translation_{0, 0, 0};
  bool can_extrapolate_ = false;
  double load_floor_ = 0.0;  // N
  std::uint32_t factorisations_ = 0, lost_factorisations_ = 0;
};

}  // namespace palpate::solve
