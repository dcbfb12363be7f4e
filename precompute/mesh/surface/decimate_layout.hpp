// SPDX-License-Identifier: GPL-3.0-or-later
// Fewer triangles for a surface that is cut into patches.
#pragma once

#include "precompute/geometry/query.hpp"
#include "precompute/mesh/surface/patch_layout.hpp"

#include <vector>

namespace palpate::mesh {

/// Collapses edges of `layout` by ascending quadric error (Garland and Heckbert 1997) where the new triangles stay
/// within `tolerance` (m) of `body`, and the points of `layout` that they replace within it of them. A site moves along
/// the surface's normal alone, a point of a path is joined with points of that path and its sites alone. `kept`: per
/// point, nonzero where it has to stay as it is. Deterministic.
PatchLayout decimate(const PatchLayout& layout, const geometry::SurfaceQuery& body, double tolerance,
                     const std::vector<char>& kept);

}  // namespace palpate::mesh
