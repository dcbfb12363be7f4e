// SPDX-License-Identifier: GPL-3.0-or-later
// The way from the flat facets of a mesh to the round surface that they stand for.
#pragma once

#include "precompute/geometry/query.hpp"
#include "precompute/mesh/tet_mesh.hpp"

#include <Eigen/Core>
#include <vector>

namespace palpate::solve {

/// Per node of the mesh the way (m) from the middle of an edge of the outer boundary to the closest point of `surface`;
/// zero at corners, which lie on the surface, and inside. On a radius R the middle of an edge of length L lies L^2 / (8
/// R) below, and a contact with the flat facets begins that much too late: a punch half as wide as a soft ball was 6 to
/// 9 % too soft (tests/measured/random-battery.md).
std::vector<Eigen::Vector3d> surface_offsets(const mesh::TetMesh& tets, const geometry::SurfaceQuery& surface);

}  // namespace palpate::solve
