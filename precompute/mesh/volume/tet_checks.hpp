// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of a mesher's tetrahedra before they are used.
#pragma once

#include "precompute/mesh/volume/linear_tets.hpp"

namespace palpate::mesh {

/// Turns tetrahedra to positive volume. Gives a cause where one is flat, a corner is out of range, or there is
/// none at all; empty when all is well.
std::string orient_tets(LinearTets& mesh);

/// Surfaces as triangles of the mesh's own points: the outer one, then the inclusions, all seen from outside.
using SurfaceTriangles = std::vector<std::array<std::int32_t, 3>>;

/// Sets the regions of a mesh that should fill `outer` and keep every triangle of `inner`, and takes out what fills the
/// cavities of `outer`. Gives a cause where the boundary is not exactly `outer`, an inner triangle is missing, or an
/// inclusion is empty.
std::string find_regions(LinearTets& mesh, const SurfaceTriangles& outer, const std::vector<SurfaceTriangles>& inner);

/// Smallest angle between two faces of a tetrahedron (degrees).
double min_dihedral(const LinearTets& mesh);

/// Volume of every region (m^3): the body's own first, then `inclusions` more.
std::vector<double> region_volumes(const LinearTets& mesh, std::size_t inclusions);

}  // namespace palpate::mesh
