// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL alpha wrap and convex hull.
#include "precompute/geometry/cgal_mesh.hpp"
#include "precompute/geometry/topology.hpp"
#include "precompute/surface/repair/kernel.hpp"

#include <CGAL/alpha_wrap_3.h>
#include <CGAL/convex_hull_3.h>

namespace palpate::surface {

Surface alpha_wrap(const Surface& soup, double alpha, double offset) {
  const auto [points, polygons] = geometry::to_cgal_soup(soup);
  std::vector<std::array<std::size_t, 3>> solid;
  for (std::size_t t = 0; t < polygons.size(); ++t) {
    if (!geometry::is_degenerate(soup, t)) solid.push_back(polygons[t]);
  }
  geometry::CgalMesh mesh;
  if (!solid.empty()) CGAL::alpha_wrap_3(points, solid, alpha, offset, mesh);
  Surface surface = geometry::from_cgal_mesh(mesh, geometry::FirstCorner::target);
  surface.part_names = {"wrap"};
  surface.parts.assign(surface.triangles.size(), 0);
  return surface;
}

double hull_volume(const Surface& surface) {
  const auto points = geometry::to_cgal_soup(surface).points;
  geometry::CgalMesh hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  if (hull.number_of_faces() < 4) return 0.0;
  return geometry::signed_volume(geometry::from_cgal_mesh(hull));
}

}  // namespace palpate::surface
