// SPDX-License-Identifier: GPL-3.0-or-later
// A push whose contact slips where Coulomb's law lets it: steps of the tool, each an equilibrium in which limits and
// pressures agree, with the energy that the slip dissipates.
#pragma once

#include "precompute/solve/contact/friction.hpp"
#include "precompute/solve/push/push.hpp"

namespace palpate::solve {

struct CoulombOptions {
  double coefficient = 0.0;     ///< > 0
  double stiffness = 0.0;       ///< Pa/m of the elastic slip, > 0
  double agreement = 0.05;      ///< largest mismatch of limits and pressures point by point, where elements show ...
  double sum_agreement = 2e-3;  ///< ... and of their sums (FrictionEnergy::mismatch)
  int rounds = 30;              ///< minimisations of a step
};

class CoulombPush {
public:
  /// Takes over `push` where it stands, with the anchors of a sticking contact, which then may slip. `push` must
  /// outlive this; its own contact is left without anchors.
  CoulombPush(Push& push, const CoulombOptions& options);
  ~CoulombPush() { push_.remove(friction_); }
  CoulombPush(const CoulombPush&) = delete;
  CoulombPush& operator=(const CoulombPush&) = delete;

  /// Moves and turns the tool to `target` and finds equilibrium, in up to 2^3 parts where one step fails; on failure
  /// the push is where the last good part left it. Radius (m) and work scale (J) as Push::move_to.
  StepResult move_to(const Eigen::Isometry3d& target, double contact_radius, double work_scale);
  /// Without turning it.
  StepResult move_to(const Eigen::Vector3d& target, double contact_radius, double work_scale);
  /// Push::let_go. The energy still stored in body and slip is returned as the last of the work, or dissipated.
  void let_go(const Eigen::Vector3d& target);

  [[nodiscard]] FrictionReport friction() const { return friction_.report(push_.state().x); }
  /// N on the tool, pressures and tractions, body frame.
  [[nodiscard]] Eigen::Vector3d force() const { return push_.report().force + friction().force; }
  /// N m on the tool about `about`, body frame.
  [[nodiscard]] Eigen::Vector3d moment(const Eigen::Vector3d& about) const {
    return friction_.moment(push_.state().x, about);
  }

  /// Energies (J): what the tool did, and what slip took, in all steps since the account was opened; what is stored in
  /// body and contact beyond what was then. Work is the trapezoidal sum over the steps.
  void open_account();
  [[nodiscard]] double work() const { return work_; }
  [[nodiscard]] double dissipated() const { return dissipated_; }
  [[nodiscard]] double stored() const { return energy() - opening_; }

private:
  StepResult step(const Eigen::Isometry3d& target, double contact_radius, double work_scale);
  [[nodiscard]] double energy() const;

  Push& push_;
  CoulombOptions options_;
  FrictionEnergy friction_;
  double work_ = 0.0, dissipated_ = 0.0, opening_ = 0.0;
  Eigen::VectorXd previous_x_;  // before the last step, for extrapolation
  Eigen::Vector3d previous_translation_{0, 0, 0};
};

/// Tangential deflection over depth at which a contact on a half-space begins to slip as a whole (Mindlin 1949): the
/// same for a sphere, formed without friction, and a flat punch.
double gross_slip_reach(double friction, double poisson);

}  // namespace palpate::solve
