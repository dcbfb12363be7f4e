// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/contact/surface_offsets.hpp"

namespace palpate::solve {

std::vector<Eigen::Vector3d> surface_offsets(const mesh::TetMesh& tets, const geometry::SurfaceQuery& surface) {
  std::vector<Eigen::Vector3d> offsets(tets.nodes.size(), Eigen::Vector3d::Zero());
  for (const auto& face : tets.faces) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t middle = face[3 + k], end = face[(k + 1) % 3];
      if (face[k] > end) continue;  // the edge's other face has it the other way round
      offsets[middle] = surface.closest(tets.nodes[middle]).point - tets.nodes[middle];
    }
  }
  return offsets;
}

}  // namespace palpate::solve
