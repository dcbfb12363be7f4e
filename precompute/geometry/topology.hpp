// SPDX-License-Identifier: GPL-3.0-or-later
// Counts and measures of a triangle soup: what is open, non-manifold, doubled, flipped, and how large it is.
#pragma once

#include "formats/surface/surface.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate::geometry {

/// One side of a triangle. Lists of these are sorted, so that the sides on one edge are neighbours.
struct TriangleSide {
  std::int32_t low = 0, high = 0;  ///< vertices, low < high
  std::int32_t triangle = 0;
  bool forward = true;  ///< the triangle runs from low to high
};

/// All sides of all triangles without repeated corners, by (low, high, triangle).
std::vector<TriangleSide> sorted_sides(const Surface& surface);

/// Calls visit(std::span<const TriangleSide>) for the sides on each edge of a sorted list.
template <class Visit>
void for_each_edge(const std::vector<TriangleSide>& sides, Visit visit) {
  auto first = sides.begin();
  while (first != sides.end()) {
    const auto last = std::find_if(first, sides.end(), [&](const TriangleSide& side) {
      return side.low != first->low || side.high != first->high;
    });
    visit(std::span(first, last));
    first = last;
  }
}

/// Disjoint sets of the numbers below `count`; a set is known by its smallest member.
class Sets {
public:
  explicit Sets(std::size_t count);
  std::size_t find(std::size_t item);
  void join(std::size_t a, std::size_t b);

private:
  std::vector<std::size_t> parent_;
};

struct Topology {
  std::size_t degenerate = 0;            ///< triangles with a repeated corner or no area
  std::size_t duplicates = 0;            ///< triangles whose three corners another has already
  std::size_t boundary_edges = 0;        ///< edges of one triangle
  std::size_t boundary_loops = 0;        ///< connected sets of those
  std::size_t nonmanifold_edges = 0;     ///< edges of three or more triangles
  std::size_t nonmanifold_vertices = 0;  ///< vertices where fans of triangles meet in that point only
  std::size_t flipped_edges = 0;         ///< edges whose two triangles do not agree on which side is out
  std::size_t components = 0;            ///< sets of triangles connected over edges

  /// A closed oriented manifold by its indices (it may still intersect itself).
  [[nodiscard]] bool closed_manifold() const noexcept {
    return degenerate + duplicates + boundary_edges + nonmanifold_edges + nonmanifold_vertices + flipped_edges == 0;
  }
};

/// Indices must be in range.
Topology topology(const Surface& surface);

/// Per triangle the number of its component, in the order of their first triangles. Edges of three or more
/// triangles connect them only with `over_nonmanifold_edges`.
std::vector<std::int32_t> triangle_components(const Surface& surface, bool over_nonmanifold_edges);

/// True when the triangle has a repeated corner or a height below 1e-10 of its longest side.
bool is_degenerate(const Surface& surface, std::size_t triangle);

Eigen::Vector3d triangle_normal(const Surface& surface, std::size_t triangle);  ///< length: twice the area (m^2)
double signed_volume(const Surface& surface);                                   ///< m^3, positive for outward triangles
double area(const Surface& surface);                                            ///< m^2
double diagonal(const Surface& surface);  ///< m, of the bounding box of the vertices in use

}  // namespace palpate::geometry
