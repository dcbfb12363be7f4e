// SPDX-License-Identifier: GPL-3.0-or-later
// Intersection tests with exact predicates, by CGAL.
#include "precompute/geometry/intersections.hpp"

#include "precompute/geometry/cgal_mesh.hpp"

#include <CGAL/Polygon_mesh_processing/intersection.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace palpate {

bool self_intersects(const Surface& surface) {
  return CGAL::Polygon_mesh_processing::does_self_intersect(to_cgal_mesh(surface));
}

std::vector<std::int32_t> crossing_triangles(const Surface& surface) {
  std::vector<std::pair<CgalMesh::Face_index, CgalMesh::Face_index>> pairs;
  CGAL::Polygon_mesh_processing::self_intersections(to_cgal_mesh(surface), std::back_inserter(pairs));
  std::vector<std::int32_t> triangles;
  for (const auto& [f, g] : pairs) {
    for (const auto face : {f, g}) triangles.push_back(static_cast<std::int32_t>(face.idx()));
  }
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

bool surfaces_intersect(const Surface& first, const Surface& second) {
  return CGAL::Polygon_mesh_processing::do_intersect(to_cgal_mesh(first), to_cgal_mesh(second));
}

}  // namespace palpate
