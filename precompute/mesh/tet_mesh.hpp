// SPDX-License-Identifier: GPL-3.0-or-later
// Quadratic tetrahedral mesh of a body for one contact site.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace palpate::mesh {

/// Straight-sided ten-node tetrahedra. Node order: corners 0-3 (positive volume), then the middles of
/// edges 01, 12, 20, 03, 13, 23. Faces: corners 0-2 (counter-clockwise from outside), middles 01, 12, 20.
struct TetMesh {
  std::vector<Eigen::Vector3d> nodes;  ///< m
  std::vector<std::array<std::int32_t, 10>> tets;
  std::vector<std::int32_t> regions;               ///< per tet: 0 the body, k the k-th inclusion (1-based)
  std::vector<std::array<std::int32_t, 6>> faces;  ///< outer boundary
  std::int32_t corner_count = 0;                   ///< nodes [0, corner_count) are corners
};

}  // namespace palpate::mesh
