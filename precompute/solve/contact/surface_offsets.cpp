// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/contact/surface_offsets.hpp"

#include <utility>

namespace palpate::solve {

std::vector<Eigen::Vector3d> surface_offsets(const mesh::TetMesh& tets, const geometry::SurfaceQuery& surface) {
  std::vector<Eigen::Vector3d> offsets(tets.nodes.size(), Eigen::Vector3d::Zero());
  std::vector<char> known(tets.nodes.size(), 0);
  for (const auto& face : tets.faces) {
    for (const std::int32_t node : face) {
      if (std::exchange(known[node], 1) == 0)
        offsets[node] = surface.closest(tets.nodes[node]).point - tets.nodes[node];
    }
  }
  return offsets;
}

}  // namespace palpate::solve
