// SPDX-License-Identifier: GPL-3.0-or-later
// Surface to CGAL::Surface_mesh and back; for the few files that use CGAL's mesh algorithms.
#pragma once

#include "formats/io/error.hpp"
#include "formats/surface/surface.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace palpate::geometry {

using CgalKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<CgalKernel::Point_3>;

inline CgalKernel::Point_3 to_cgal(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }
inline Eigen::Vector3d to_eigen(const CgalKernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }

/// Points and polygons, as CGAL's functions for soups take them.
struct CgalSoup {
  std::vector<CgalKernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> polygons;
};

inline CgalSoup to_cgal_soup(const Surface& surface) {
  CgalSoup soup;
  for (const Eigen::Vector3d& v : surface.vertices) soup.points.push_back(to_cgal(v));
  for (const auto& t : surface.triangles) {
    soup.polygons.push_back(
        {static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2])});
  }
  return soup;
}

/// Throws Error(bad_input) where a triangle does not fit a manifold, oriented surface. Vertex and triangle
/// numbers are kept, so unused vertices stay, isolated.
inline CgalMesh to_cgal_mesh(const Surface& surface) {
  CgalMesh mesh;
  mesh.reserve(static_cast<CgalMesh::size_type>(surface.vertices.size()),
               static_cast<CgalMesh::size_type>(surface.triangles.size() * 3 / 2),
               static_cast<CgalMesh::size_type>(surface.triangles.size()));
  for (const Eigen::Vector3d& v : surface.vertices) mesh.add_vertex(to_cgal(v));
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& t = surface.triangles[i];
    const auto vertex = [&](int k) { return CgalMesh::Vertex_index(static_cast<CgalMesh::size_type>(t[k])); };
    if (mesh.add_face(vertex(0), vertex(1), vertex(2)) == CgalMesh::null_face()) {
      throw Error(ExitCode::bad_input,
                  "surface triangle " + std::to_string(i) + ": does not fit a manifold, consistently oriented surface");
    }
  }
  return mesh;
}

/// Corner that triangles begin with: an end of the halfedge that the mesh stores for the face.
enum class FirstCorner { source, target };

/// Vertices in the mesh's order, those without a triangle left out; triangles in the order of the faces; no parts.
inline Surface from_cgal_mesh(const CgalMesh& mesh, FirstCorner first = FirstCorner::source) {
  Surface surface;
  std::vector<std::int32_t> number(mesh.num_vertices() + mesh.number_of_removed_vertices(), -1);
  for (const auto v : mesh.vertices()) {
    if (mesh.is_isolated(v)) continue;
    number[v] = static_cast<std::int32_t>(surface.vertices.size());
    surface.vertices.push_back(to_eigen(mesh.point(v)));
  }
  for (const auto f : mesh.faces()) {
    const auto h = first == FirstCorner::source ? mesh.halfedge(f) : mesh.next(mesh.halfedge(f));
    surface.triangles.push_back({number[mesh.source(h)], number[mesh.target(h)], number[mesh.target(mesh.next(h))]});
  }
  return surface;
}

}  // namespace palpate::geometry
