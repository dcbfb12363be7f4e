// SPDX-License-Identifier: GPL-3.0-or-later
// Load stepping: brings a body from its stress-free state to the equilibrium under its prestress.
#pragma once

#include "precompute/fem/minimiser.hpp"
#include "precompute/solve/contact/body_energy.hpp"

#include <string>

namespace palpate::solve {

struct Settled {
  bool reached = false;
  std::string cause;          ///< why not, with the share that was reached
  double share = 0.0;         ///< of the loads that were reached
  double min_jacobian = 1.0;  ///< there
  std::uint32_t steps = 0;    ///< that were accepted
  std::uint32_t iterations = 0, factorisations = 0;
};

/// Raises weight, pressure and stretch together from 0 to the scene's values, in steps that are halved where one
/// fails, and minimises after each; then until half the Newton decrement squared is below `energy_tolerance` (J). A
/// step is accepted when no element is inside out and the energy changed by the work of the loads (a step that
/// jumps to another equilibrium leaves energy over). On success x (3 N, m; at first the mesh's nodes) is the
/// equilibrium. Never throws for a numerical failure.
Settled settle(BodyEnergy& body, fem::Minimiser& minimiser, Eigen::VectorXd& x, double energy_tolerance);

}  // namespace palpate::solve
