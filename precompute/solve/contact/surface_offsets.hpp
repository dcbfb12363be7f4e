// SPDX-License-Identifier: GPL-3.0-or-later
// The way from the flat facets of a mesh to the round surface that they stand for.
#pragma once

#include "precompute/geometry/query.hpp"
#include "precompute/mesh/tet_mesh.hpp"

#include <Eigen/Core>
#include <vector>

namespace palpate::solve {

/// Per node of the mesh's faces the way (m) to the closest point of `surface`; zero inside. Facets lie in the mean on a
/// round surface (mesh/surface/balance_facets.hpp): their corners stand out of it, middles of edges lie below.
/// A contact with flat facets whose corners are on the surface begins too late, by L^2 / (8 R) at the middle of an edge
/// of length L on a radius R: a punch half as wide as a soft ball was 6 to 9 % too soft
/// (tests/measured/random-battery.md).
std::vector<Eigen::Vector3d> surface_offsets(const mesh::TetMesh& tets, const geometry::SurfaceQuery& surface);

}  // namespace palpate::solve
