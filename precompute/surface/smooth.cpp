// SPDX-License-Identifier: GPL-3.0-or-later
// OpenMesh's subdivider between two copies.
#include "precompute/surface/smooth.hpp"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/ModifiedButterFlyT.hh>
#include <algorithm>

namespace palpate {
namespace {

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

}  // namespace

Surface smooth(const Surface& surface, int rounds) {
  Mesh mesh;
  for (const auto& v : surface.vertices) mesh.add_vertex({v.x(), v.y(), v.z()});
  for (const auto& t : surface.triangles) {
    mesh.add_face(Mesh::VertexHandle(t[0]), Mesh::VertexHandle(t[1]), Mesh::VertexHandle(t[2]));
  }
  std::size_t valence = 0;
  for (const auto v : mesh.vertices()) valence = std::max(valence, std::size_t(mesh.valence(v)));
  OpenMesh::Subdivider::Uniform::ModifiedButterflyT<Mesh, double> subdivider;
  subdivider.init_weights(std::max<std::size_t>(valence + 1, 7));  // older versions do not check their table's end
  subdivider.attach(mesh);
  subdivider(std::size_t(rounds));
  subdivider.detach();

  Surface result;
  result.part_names = surface.part_names;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    result.vertices.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : mesh.faces()) {
    std::array<std::int32_t, 3> t{};
    int k = 0;
    for (const auto v : mesh.fv_range(f)) t[k++] = v.idx();
    result.triangles.push_back(t);
  }
  result.parts.assign(result.triangles.size(), -1);
  return result;
}

}  // namespace palpate
