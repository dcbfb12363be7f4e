// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL alpha wrap and convex hull.
#include "precompute/surface/kernel.hpp"
#include "precompute/surface/topology.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#include <CGAL/convex_hull_3.h>

namespace palpate {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

std::vector<Point> points_of(const Surface& surface) {
  std::vector<Point> points;
  for (const auto& p : surface.vertices) points.emplace_back(p.x(), p.y(), p.z());
  return points;
}

Surface surface_of(const Mesh& mesh) {
  Surface surface;
  surface.part_names = {"wrap"};
  std::vector<std::int32_t> number(mesh.num_vertices() + mesh.number_of_removed_vertices(), -1);
  for (const auto vertex : mesh.vertices()) {
    number[std::size_t(vertex)] = std::int32_t(surface.vertices.size());
    const auto& p = mesh.point(vertex);
    surface.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto face : mesh.faces()) {
    std::array<std::int32_t, 3> corners{};
    std::size_t k = 0;
    for (const auto vertex : CGAL::vertices_around_face(mesh.halfedge(face), mesh))
      corners[k++] = number[std::size_t(vertex)];
    surface.triangles.push_back(corners);
  }
  surface.parts.assign(surface.triangles.size(), 0);
  return surface;
}

}  // namespace

Surface alpha_wrap(const Surface& soup, double alpha, double offset) {
  const auto points = points_of(soup);
  std::vector<std::array<std::size_t, 3>> faces;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const auto& t = soup.triangles[i];
    if (!is_degenerate(soup, i)) faces.push_back({std::size_t(t[0]), std::size_t(t[1]), std::size_t(t[2])});
  }
  Mesh mesh;
  if (!faces.empty()) CGAL::alpha_wrap_3(points, faces, alpha, offset, mesh);
  return surface_of(mesh);
}

double hull_volume(const Surface& surface) {
  const auto points = points_of(surface);
  Mesh hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  if (hull.number_of_faces() < 4) return 0.0;
  return signed_volume(surface_of(hull));
}

}  // namespace palpate
