// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/contact/surface_offsets.hpp"

#include "precompute/mesh/surface/adapt_surface.hpp"

namespace palpate::solve {

std::vector<Eigen::Vector3d> surface_offsets(const mesh::TetMesh& tets, const geometry::SurfaceQuery& surface) {
  std::vector<Eigen::Vector3d> offsets(tets.nodes.size(), Eigen::Vector3d::Zero());
  std::vector<char> known(tets.nodes.size(), 0);
  const double chord = mesh::AdaptOptions{}.chord;
  for (const auto& face : tets.faces) {
    for (int k = 0; k < 3; ++k) {  // the middle of the edge from corner k
      const std::int32_t middle = face[3 + k];
      if (known[middle] != 0) continue;
      known[middle] = 1;
      const double length = (tets.nodes[face[(k + 1) % 3]] - tets.nodes[face[k]]).norm();
      const auto closest = surface.closest(tets.nodes[middle]);
      if (closest.distance <= chord * length) offsets[middle] = closest.point - tets.nodes[middle];
    }
  }
  return offsets;
}

}  // namespace palpate::solve
