// SPDX-License-Identifier: GPL-3.0-or-later
// Validation: everything that keeps a surface from being meshed as a solid.
#pragma once

#include "precompute/geometry/topology.hpp"

#include <string>
#include <vector>

namespace palpate::surface {

struct SurfaceFaults {
  geometry::Topology topology;
  std::size_t crossings = 0;  ///< pairs of triangles that intersect, after merging equal points
  double volume = 0.0;        ///< m^3, signed; meaningless while open

  /// A closed oriented manifold, outside out, that does not intersect itself and holds some volume.
  [[nodiscard]] bool clean() const noexcept;
  /// One line for each kind of fault, and one when there are several components; empty for a plain clean body.
  [[nodiscard]] std::vector<std::string> lines() const;
};

/// Throws Error(bad_input), naming `name` and the vertex or triangle, for NaN or infinite coordinates,
/// indices out of range, no triangles, and coordinates all at one point.
void require_usable(const Surface& surface, const std::string& name);

/// The surface must have passed require_usable.
SurfaceFaults examine(const Surface& surface);

/// "a; b; c"
std::string joined(const std::vector<std::string>& lines);

}  // namespace palpate::surface
