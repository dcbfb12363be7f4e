// SPDX-License-Identifier: MIT
// Reads curves in space: lines of an OBJ file, or a table of points.
#pragma once

#include "formats/scene/scene.hpp"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace palpate {

/// Points (m) and the straight pieces between them, each a pair of different points with some distance. Pieces that
/// share a point go on from each other.
struct Curves {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<std::int32_t, 2>> pieces;
};

/// OBJ: the lines (`l`) of the groups or objects in `source.meshes` (all when empty). CSV: one curve, a point (x, y, z)
/// a row, separated by commas, semicolons or blanks; the first row may name the columns.
/// Throws Error(io) when the file cannot be read; Error(bad_input) "file:line: cause" for another extension, a damaged
/// line, an index out of range, a piece without length, a missing name, and a file without a curve.
Curves read_curves(const SurfaceSource& source);

}  // namespace palpate
