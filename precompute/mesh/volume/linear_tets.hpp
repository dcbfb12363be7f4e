// SPDX-License-Identifier: GPL-3.0-or-later
// Linear tetrahedra as the meshers give them, and the closed surfaces that they must respect.
#pragma once

#include "formats/surface/surface.hpp"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace palpate::mesh {

struct LinearTets {
  std::vector<Eigen::Vector3d> points;            ///< m
  std::vector<std::array<std::int32_t, 4>> tets;  ///< positive volume
  std::vector<std::int32_t> regions;              ///< per tet: 0 the body, k the k-th inclusion (1-based)
};

/// The result of one attempt of one mesher: tets, or why there are none.
struct MesherAnswer {
  LinearTets tets;
  std::string cause;            ///< empty when tets hold a mesh
  double helper_seconds = 0.0;  ///< processor time of a helper process
};

}  // namespace palpate::mesh
