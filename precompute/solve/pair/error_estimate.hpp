// SPDX-License-Identifier: GPL-3.0-or-later
// How far a solved force may be off: what the iteration, the penalty and the mesh each leave.
#pragma once

#include <cstdint>

namespace palpate {

/// One equilibrium.
struct ErrorSources {
  double force = 0.0;              ///< N, > 0
  double depth = 0.0;              ///< m, the tool's, > 0
  double give = 0.0;               ///< m, taken off the depth for the contact's compliance
  double energy_error = 0.0;       ///< J, see StepResult
  double contact_stiffness = 0.0;  ///< N/m, of the penalty over all of the contact's area
  std::uint32_t points = 0;        ///< integration points in contact
  double growth = 0.7;             ///< of the mesh's edges per distance from the contact
};

/// Relative error of the force, calibrated on a block against solves on finer meshes.
double error_estimate(const ErrorSources& sources);

}  // namespace palpate
