// SPDX-License-Identifier: GPL-3.0-or-later
// The patches of a haptic mesh on the body's own surface: cuts it along a path for each edge between two sites.
#pragma once

#include "formats/surface/surface.hpp"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace palpate::mesh {

/// A side of a patch: its sites, lower first.
using PatchSide = std::array<std::int32_t, 2>;

/// Place of a point of the surface among the paths: at a site, or on the path of a side between its sites, or on
/// none.
struct PathPlace {
  std::int32_t site = -1, side = -1;
};

/// A closed triangle surface, each triangle of which lies in one patch. No edge but those of a path joins two points of
/// one path.
struct PatchLayout {
  std::vector<Eigen::Vector3d> points;                 ///< m; the sites come first
  std::vector<PathPlace> places;                       ///< per point
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< corners, counter-clockwise from outside
  std::vector<std::int32_t> patch;                     ///< per triangle
  std::vector<PatchSide> sides;                        ///< of all patches, ascending
};

/// The sides of all patches, ascending.
std::vector<PatchSide> patch_sides(const std::vector<std::array<std::int32_t, 3>>& patches);

/// True where both places lie on the path of one side.
bool share_path(const std::vector<PatchSide>& sides, const PathPlace& a, const PathPlace& b);

/// Cuts `body` (closed, manifold) into patches without moving it. `sites` are points on it (m); `patches` is a closed
/// manifold mesh of them. Paths are about as short as they can be without a crossing. Deterministic.
/// Throws Error(numerical) where a path does not exist or a patch is not a disk: the patches then have another topology
/// than the body.
PatchLayout lay_out_patches(const Surface& body, const std::vector<Eigen::Vector3d>& sites,
                            const std::vector<std::array<std::int32_t, 3>>& patches);

}  // namespace palpate::mesh
