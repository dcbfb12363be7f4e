// SPDX-License-Identifier: GPL-3.0-or-later
// Asks the TetGen worker process for tetrahedra inside a closed surface.
#pragma once

#include "precompute/mesh/volume/linear_tets.hpp"

namespace palpate::mesh {

/// One meshing request. Facets of inner surfaces stand among those of the outer one.
struct TetgenInput {
  std::vector<Eigen::Vector3d> vertices;  ///< m; a vertex that no facet uses is an interior point
  std::vector<double> sizes;              ///< m, target edge length at each vertex
  std::vector<std::array<std::int32_t, 3>> facets;
  std::string switches;  ///< TetGen's, without the dash; must hold p, m and Q
};

/// Meshes within `time_limit` s of processor time; gives a cause where TetGen does not. TetGen leaves the regions to
/// find_regions. Throws Error(io) where palpate-tetgen is missing or cannot be started.
MesherAnswer run_tetgen(const TetgenInput& input, double time_limit);

}  // namespace palpate::mesh
