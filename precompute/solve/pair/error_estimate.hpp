// SPDX-License-Identifier: GPL-3.0-or-later
// How far a solved force may be off: on its mesh, by the iteration, the penalty and few points of contact; and by the
// mesh.
#pragma once

#include "precompute/solve/pair/pair.hpp"

#include <cstdint>
#include <vector>

namespace palpate::solve {

/// One equilibrium.
struct ErrorSources {
  double force = 0.0;              ///< N, > 0
  double depth = 0.0;              ///< m, the tool's, > 0
  double give = 0.0;               ///< m, taken off the depth for the contact's compliance
  double energy_error = 0.0;       ///< J, see StepResult
  double contact_stiffness = 0.0;  ///< N/m, of the penalty over all of the contact's area
  std::uint32_t points = 0;        ///< integration points in contact
};

/// Relative error of the force, without what the mesh leaves (add_mesh_errors).
double error_estimate(const ErrorSources& sources);

/// The pushes that the other mesh is compared by: the normal indentation, and from each tangential depth one tangential
/// move as far as the first point of `path`'s.
PairPath compared_path(PairPath path);

/// Adds `share` of the relative difference to `other` to every sample's error estimate. Normal samples: the largest
/// of the difference at their own and at the neighbouring depths. Others: that of the nearest depth, and of the change
/// of the force since the normal indentation the share by which the tangential moves differ at the nearest depth they
/// have. False, and nothing added, where no normal sample has a partner in `other` (sample_difference).
bool add_mesh_errors(std::vector<Sample>& samples, const std::vector<Sample>& other, double share);

}  // namespace palpate::solve
