// SPDX-License-Identifier: GPL-3.0-or-later
// Soup repairs that need no geometry kernel: merging points, joining borders, dropping doubles and fins.
#pragma once

#include "formats/surface/surface.hpp"

namespace palpate::surface {

/// Merges vertices that lie within `tolerance` (m, >= 0) of each other into the one with the lowest number,
/// drops triangles that lose a corner by it and vertices without a triangle.
Surface weld(const Surface& surface, double tolerance);

/// Merges border vertices of different parts that are each other's nearest within `tolerance` (m) and within
/// a third of the border edges at both, so that named meshes whose rims match become one.
Surface join_borders(const Surface& surface, double tolerance);

struct Split {
  Surface surface;
  std::size_t edges = 0, vertices = 0;  ///< where sheets touched
};

/// Takes apart what touches in an edge or a corner only, as the blocks of a voxel surface do: at an edge of four or
/// more triangles those stay together that bound the same wedge of the solid. The copies of a vertex move into their
/// own blocks by a hundredth of their shortest edge, nothing else moves. The surface is to be oriented; where the
/// triangles at an edge do not pair up, nothing is done.
Split split_touching(const Surface& surface);

/// Keeps one of the triangles that share all three corners.
Surface drop_duplicates(const Surface& surface);

/// Removes sheets that hang on a surface by an edge of three or more triangles and are open elsewhere, when
/// they are less than a tenth of the whole area.
Surface drop_fins(const Surface& surface);

/// Removes components of less than `share` of the whole area.
Surface drop_small_components(const Surface& surface, double share);

/// Keeps the triangles for which keep is true, and the vertices they use, in their order.
Surface keep_triangles(const Surface& surface, const std::vector<bool>& keep);

/// Several surfaces as one soup; part names stay, also where two are equal.
Surface join(const std::vector<Surface>& surfaces);

}  // namespace palpate::surface
