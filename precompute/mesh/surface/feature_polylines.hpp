// SPDX-License-Identifier: GPL-3.0-or-later
// A surface's feature lines as polylines between their corners.
#pragma once

#include "precompute/geometry/query.hpp"

#include <vector>

namespace palpate::mesh {

/// Every feature edge of the surface in exactly one polyline. Polylines end at corners (branchings, ends, bends
/// of more than 40 degrees) and at `stops` that lie on a line; one without such a point closes on itself.
std::vector<std::vector<Eigen::Vector3d>> feature_polylines(const geometry::SurfaceQuery& query,
                                                            const std::vector<Eigen::Vector3d>& stops);

}  // namespace palpate::mesh
