// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL Polygon_mesh_processing: exact crossings of triangles, and repair of a soup into an oriented mesh.
#include "precompute/surface/kernel.hpp"
#include "precompute/surface/topology.hpp"
#include "precompute/surface/weld.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/box_intersection_d.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace palpate {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = Kernel::Triangle_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::int32_t>;
namespace pmp = CGAL::Polygon_mesh_processing;

Point point(const Surface& surface, std::int32_t vertex) {
  const auto& p = surface.vertices[std::size_t(vertex)];
  return {p.x(), p.y(), p.z()};
}

Triangle triangle(const Surface& surface, std::int32_t number) {
  const auto& t = surface.triangles[std::size_t(number)];
  return {point(surface, t[0]), point(surface, t[1]), point(surface, t[2])};
}

std::vector<Box> boxes(const Surface& surface) {
  std::vector<Box> result;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    if (is_degenerate(surface, i)) continue;
    result.emplace_back(triangle(surface, std::int32_t(i)).bbox(), std::int32_t(i));
  }
  return result;
}

// Whether two triangles of one surface meet anywhere but in what they share by index.
bool cross(const Surface& surface, std::int32_t a, std::int32_t b) {
  auto s = surface.triangles[std::size_t(a)], t = surface.triangles[std::size_t(b)];
  // Shared corners to the front, in the same order in both.
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto found = std::find(t.begin() + std::ptrdiff_t(shared), t.end(), s[i]);
    if (found == t.end()) continue;
    std::swap(t[shared], *found);
    std::swap(s[shared], s[i]);
    ++shared;
  }
  if (shared == 0) return CGAL::do_intersect(triangle(surface, a), triangle(surface, b));
  if (shared == 3) return true;
  const auto p = [&](std::int32_t v) { return point(surface, v); };
  if (shared == 2) {
    return CGAL::coplanar(p(s[0]), p(s[1]), p(s[2]), p(t[2])) &&
           CGAL::coplanar_orientation(p(s[0]), p(s[1]), p(s[2]), p(t[2])) == CGAL::POSITIVE;
  }
  return CGAL::do_intersect(Kernel::Segment_3(p(s[1]), p(s[2])), triangle(surface, b)) ||
         CGAL::do_intersect(Kernel::Segment_3(p(t[1]), p(t[2])), triangle(surface, a));
}

std::optional<Mesh> mesh_of(const Surface& surface) {
  std::vector<Point> points;
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) points.push_back(point(surface, std::int32_t(v)));
  std::vector<std::array<std::size_t, 3>> polygons;
  for (const auto& t : surface.triangles) polygons.push_back({std::size_t(t[0]), std::size_t(t[1]), std::size_t(t[2])});
  // Keeps the order of the polygons and doubles the points where the soup is not a manifold.
  pmp::orient_polygon_soup(points, polygons);
  if (!pmp::is_polygon_soup_a_polygon_mesh(polygons)) return std::nullopt;
  Mesh mesh;
  pmp::polygon_soup_to_polygon_mesh(points, polygons, mesh);
  auto parts = mesh.add_property_map<Mesh::Face_index, std::int32_t>("f:part", -1).first;
  std::size_t next = 0;
  for (const auto face : mesh.faces()) parts[face] = surface.parts[next++];
  return mesh;
}

// Area of the fan from the middle of a hole's corners to its edges.
double fan_area(const Mesh& mesh, Mesh::Halfedge_index hole) {
  std::vector<Eigen::Vector3d> rim;
  for (const auto h : CGAL::halfedges_around_face(hole, mesh)) {
    const auto& p = mesh.point(mesh.target(h));
    rim.emplace_back(p.x(), p.y(), p.z());
  }
  Eigen::Vector3d middle(0, 0, 0);
  for (const auto& p : rim) middle += p / double(rim.size());
  double area = 0.0;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    area += (rim[k] - middle).cross(rim[(k + 1) % rim.size()] - middle).norm() / 2;
  }
  return area;
}

// Closes the holes that are small; the patches take the part of a neighbour.
void close_holes(Mesh& mesh, double largest) {
  auto parts = mesh.property_map<Mesh::Face_index, std::int32_t>("f:part").first;
  std::vector<Mesh::Halfedge_index> holes;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(holes));
  for (const auto hole : holes) {
    if (!(fan_area(mesh, hole) <= largest)) continue;
    const auto part = parts[mesh.face(mesh.opposite(hole))];
    std::vector<Mesh::Face_index> patch;
    pmp::triangulate_hole(mesh, hole, std::back_inserter(patch));
    for (const auto face : patch) parts[face] = part;
  }
}

Surface surface_of(const Mesh& mesh, const std::vector<std::string>& part_names) {
  const auto parts = mesh.property_map<Mesh::Face_index, std::int32_t>("f:part").first;
  Surface surface;
  surface.part_names = part_names;
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
    surface.parts.push_back(parts[face]);
  }
  return surface;
}

}  // namespace

std::vector<std::array<std::int32_t, 2>> crossings(const Surface& surface) {
  auto all = boxes(surface);
  std::vector<std::array<std::int32_t, 2>> pairs;
  CGAL::box_self_intersection_d(all.begin(), all.end(), [&](const Box& a, const Box& b) {
    if (cross(surface, a.info(), b.info()))
      pairs.push_back({std::min(a.info(), b.info()), std::max(a.info(), b.info())});
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::size_t crossings(const Surface& a, const Surface& b) {
  auto first = boxes(a), second = boxes(b);
  std::size_t count = 0;
  CGAL::box_intersection_d(first.begin(), first.end(), second.begin(), second.end(), [&](const Box& s, const Box& t) {
    count += CGAL::do_intersect(triangle(a, s.info()), triangle(b, t.info()));
  });
  return count;
}

std::optional<Surface> mend(const Surface& surface, const MendOptions& options) {
  if (surface.empty()) return std::nullopt;
  // CGAL's orientation reads through the missing halfedge of a vertex without triangles.
  auto mesh = mesh_of(keep_triangles(surface, std::vector<bool>(surface.triangles.size(), true)));
  if (!mesh) return std::nullopt;
  pmp::stitch_borders(*mesh);
  pmp::remove_degenerate_faces(*mesh);
  if (options.hole_area > 0) close_holes(*mesh, options.hole_area);
  if (mesh->number_of_faces() == 0) return std::nullopt;
  if (CGAL::is_closed(*mesh)) pmp::orient_to_bound_a_volume(*mesh);
  mesh->collect_garbage();
  return surface_of(*mesh, surface.part_names);
}

}  // namespace palpate
