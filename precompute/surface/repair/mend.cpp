// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL Polygon_mesh_processing: repair of a soup into an oriented mesh.
#include "precompute/geometry/cgal_mesh.hpp"
#include "precompute/surface/repair/kernel.hpp"
#include "precompute/surface/repair/weld.hpp"

#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <Eigen/Geometry>

namespace palpate::surface {
namespace {

using Mesh = geometry::CgalMesh;
namespace pmp = CGAL::Polygon_mesh_processing;

std::optional<Mesh> mesh_of(const Surface& surface) {
  auto [points, polygons] = geometry::to_cgal_soup(surface);
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
  for (const auto h : CGAL::halfedges_around_face(hole, mesh))
    rim.push_back(geometry::to_eigen(mesh.point(mesh.target(h))));
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
  Surface surface = geometry::from_cgal_mesh(mesh, geometry::FirstCorner::target);
  surface.part_names = part_names;
  for (const auto face : mesh.faces()) surface.parts.push_back(parts[face]);
  return surface;
}

}  // namespace

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

}  // namespace palpate::surface
