// SPDX-License-Identifier: GPL-3.0-or-later
// Surface to CGAL::Surface_mesh and back; for the few files that use CGAL's mesh algorithms.
#pragma once

#include "formats/error.hpp"
#include "formats/surface.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <string>
#include <vector>

namespace palpate {

using CgalKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<CgalKernel::Point_3>;

/// Throws Error(bad_input) where a triangle does not fit a manifold, oriented surface. Vertex and triangle
/// numbers are kept, so unused vertices stay, isolated.
inline CgalMesh to_cgal_mesh(const Surface& surface) {
  CgalMesh mesh;
  mesh.reserve(static_cast<CgalMesh::size_type>(surface.vertices.size()),
               static_cast<CgalMesh::size_type>(surface.triangles.size() * 3 / 2),
               static_cast<CgalMesh::size_type>(surface.triangles.size()));
  for (const Eigen::Vector3d& v : surface.vertices) mesh.add_vertex({v.x(), v.y(), v.z()});
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

/// Vertices in the mesh's order, those without a triangle left out; no parts.
inline Surface from_cgal_mesh(const CgalMesh& mesh) {
  Surface surface;
  std::vector<std::int32_t> number(mesh.num_vertices() + mesh.number_of_removed_vertices(), -1);
  for (const auto v : mesh.vertices()) {
    if (mesh.is_isolated(v)) continue;
    number[v] = static_cast<std::int32_t>(surface.vertices.size());
    const auto& p = mesh.point(v);
    surface.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : mesh.faces()) {
    const auto h = mesh.halfedge(f);
    surface.triangles.push_back({number[mesh.source(h)], number[mesh.target(h)], number[mesh.target(mesh.next(h))]});
  }
  return surface;
}

}  // namespace palpate
