// SPDX-License-Identifier: GPL-3.0-or-later
// Isotropic remeshing by CGAL with sharp edges protected, retried finer where the result crosses itself.
#include "precompute/mesh/surface/remesh.hpp"

#include "precompute/geometry/cgal_mesh.hpp"
#include "precompute/geometry/intersections.hpp"
#include "precompute/geometry/query.hpp"

#include <CGAL/Polygon_mesh_processing/remesh.h>

namespace palpate::mesh {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;

Surface remesh_once(const Surface& surface, const std::vector<std::array<std::int32_t, 2>>& features, double edge) {
  geometry::CgalMesh mesh = geometry::to_cgal_mesh(surface);
  auto sharp = mesh.add_property_map<geometry::CgalMesh::Edge_index, bool>("e:sharp", false).first;
  for (const auto& [a, b] : features) {
    const auto vertex = [](std::int32_t v) {
      return geometry::CgalMesh::Vertex_index(static_cast<geometry::CgalMesh::size_type>(v));
    };
    const auto h = mesh.halfedge(vertex(a), vertex(b));
    if (h != geometry::CgalMesh::null_halfedge()) sharp[mesh.edge(h)] = true;
  }
  PMP::isotropic_remeshing(mesh.faces(), edge, mesh,
                           CGAL::parameters::number_of_iterations(5)
                               .number_of_relaxation_steps(2)
                               .edge_is_constrained_map(sharp)
                               .collapse_constraints(true));
  mesh.collect_garbage();
  return geometry::from_cgal_mesh(mesh);
}

}  // namespace

Surface remesh_uniform(const Surface& surface, double edge) {
  if (!(edge > 0)) throw Error(ExitCode::bad_input, "remesh: edge length " + std::to_string(edge) + " m, allowed > 0");
  const geometry::SurfaceQuery query(surface);
  for (const double shorter : {1.0, 0.7, 0.5, 0.35}) {
    Surface result = remesh_once(surface, query.feature_edges(), shorter * edge);
    if (result.empty() || geometry::self_intersects(result)) continue;
    result.part_names = surface.part_names;
    result.parts.reserve(result.triangles.size());
    for (const auto& t : result.triangles) {
      const Eigen::Vector3d middle = (result.vertices[t[0]] + result.vertices[t[1]] + result.vertices[t[2]]) / 3;
      result.parts.push_back(surface.parts.empty() ? 0 : surface.parts[query.closest(middle).triangle]);
    }
    return result;
  }
  return surface;
}

}  // namespace palpate::mesh
