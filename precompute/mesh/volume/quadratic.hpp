// SPDX-License-Identifier: GPL-3.0-or-later
// Linear tetrahedra to the quadratic mesh that the solver takes.
#pragma once

#include "precompute/mesh/tet_mesh.hpp"
#include "precompute/mesh/volume/linear_tets.hpp"

namespace palpate::mesh {

/// Adds the middles of edges and the outer boundary. Corners keep their order (unused points go); middles are
/// numbered as the tetrahedra meet them. The tetrahedra must be positive and have their regions.
TetMesh make_quadratic(const LinearTets& linear);

}  // namespace palpate::mesh
