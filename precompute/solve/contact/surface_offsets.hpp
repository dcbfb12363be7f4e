// SPDX-License-Identifier: GPL-3.0-or-later
// The way from the flat facets of a mesh to the round surface that they stand for.
#pragma once

#include "precompute/geometry/query.hpp"
#include "precompute/mesh/tet_mesh.hpp"

#include <Eigen/Core>
#include <vector>

namespace palpate::solve {

/// Per node of the mesh the way (m) to the closest point of `surface`, zero off the outer boundary. Corners of facets
/// lie on the surface; the middle of an edge lies below it by its length squared over 8 radii. A contact with the flat
/// facets begins that much too late: on a ball with edges of a fifth of its radius, 2 mm deep at 5 mm, the force is 3 %
/// too low. Zero as well where the surface is further away than the mesh's facets may lie (mesh::AdaptOptions::chord):
/// in a crease that an edge cuts off.
std::vector<Eigen::Vector3d> surface_offsets(const mesh::TetMesh& tets, const geometry::SurfaceQuery& surface);

}  // namespace palpate::solve
