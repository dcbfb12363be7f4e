// SPDX-License-Identifier: GPL-3.0-or-later
// Tetrahedra by CGAL Mesh_3: slower than TetGen and with a boundary of its own, but it needs no clean surface mesh.
#pragma once

#include "precompute/common/body.hpp"
#include "precompute/common/processor_time.hpp"
#include "precompute/mesh/size_field.hpp"
#include "precompute/mesh/volume/linear_tets.hpp"

namespace palpate::mesh {

/// Meshes body and inclusions to the size field, with a node at every anchor (on the surface) and the feature
/// lines kept. Deterministic; safe from several threads. Throws Error(numerical) past `deadline`; a failure inside CGAL
/// comes out as a std::exception.
MesherAnswer mesh_by_mesh3(const Body& body, const SizeField& size, const std::vector<Eigen::Vector3d>& anchors,
                           const Deadline& deadline);

}  // namespace palpate::mesh
