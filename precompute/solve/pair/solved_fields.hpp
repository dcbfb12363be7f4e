// SPDX-License-Identifier: GPL-3.0-or-later
// Displacement and stress of a solved contact, for viewers.
#pragma once

#include "formats/fields/volume_vtu.hpp"
#include "precompute/common/body.hpp"
#include "precompute/mesh/tet_mesh.hpp"

#include <Eigen/Core>

namespace palpate::solve {

/// The state with the node positions `x` (3 N, m) of a mesh of `body`. Stresses are those in the middles of the
/// elements, with the pressure of the elements' mean dilatation, as they are solved.
VolumeFields solved_fields(const Body& body, const mesh::TetMesh& mesh, const Eigen::VectorXd& x);

}  // namespace palpate::solve
