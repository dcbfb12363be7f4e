// SPDX-License-Identifier: GPL-3.0-or-later
// A body with a void in it, for what acts in cavities.
#pragma once

#include "precompute/mesh/volume/quadratic.hpp"
#include "tests/support/block_mesh.hpp"

#include <vector>

namespace palpate::test {

inline const std::vector<double> kHollowLines{0, 0.9, 2, 3};

/// A block of 3 x 3 x 3 cells without the one in the middle.
inline mesh::TetMesh hollow_block() {
  const mesh::TetMesh block = block_mesh(kHollowLines, kHollowLines, kHollowLines);
  mesh::LinearTets tets;
  tets.points.assign(block.nodes.begin(), block.nodes.begin() + block.corner_count);
  for (const auto& t : block.tets) {
    const Eigen::Vector3d middle = (block.nodes[t[0]] + block.nodes[t[1]] + block.nodes[t[2]] + block.nodes[t[3]]) / 4;
    if ((middle.array() > 0.9).all() && (middle.array() < 2).all()) continue;
    tets.tets.push_back({t[0], t[1], t[2], t[3]});
    tets.regions.push_back(0);
  }
  return mesh::make_quadratic(tets);
}

}  // namespace palpate::test
