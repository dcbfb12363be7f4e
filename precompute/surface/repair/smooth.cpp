// SPDX-License-Identifier: GPL-3.0-or-later
// OpenMesh's subdivider between two copies, a round at a time.
#include "precompute/surface/repair/smooth.hpp"

#include "precompute/geometry/intersections.hpp"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/ModifiedButterFlyT.hh>
#include <algorithm>
#include <array>

namespace palpate::surface {
namespace {

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using SkinMesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

Surface subdivided(const Surface& surface) {
  SkinMesh mesh;
  for (const auto& v : surface.vertices) mesh.add_vertex({v.x(), v.y(), v.z()});
  for (const auto& t : surface.triangles) {
    mesh.add_face(SkinMesh::VertexHandle(t[0]), SkinMesh::VertexHandle(t[1]), SkinMesh::VertexHandle(t[2]));
  }
  std::size_t valence = 0;
  for (const auto v : mesh.vertices()) valence = std::max(valence, std::size_t(mesh.valence(v)));
  OpenMesh::Subdivider::Uniform::ModifiedButterflyT<SkinMesh, double> subdivider;
  subdivider.init_weights(std::max<std::size_t>(valence + 1, 7));  // older versions do not check their table's end
  subdivider.attach(mesh);
  subdivider(1);
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

// A round's new vertices and the ends of the edges that they halve: those of the vertices before that they meet.
class Halved {
public:
  Halved(Surface& surface, std::size_t before)
      : surface_(surface), before_(before), ends_(surface.vertices.size() - before, {-1, -1}), straight_(ends_.size()) {
    for (const auto& t : surface.triangles) {
      for (int k = 0; k < 3; ++k) {
        if (is_new(t[k]) && !is_new(t[(k + 1) % 3])) take(t[k], t[(k + 1) % 3]);
        if (is_new(t[k]) && !is_new(t[(k + 2) % 3])) take(t[k], t[(k + 2) % 3]);
      }
    }
  }

  /// Moves the new vertices of these triangles to the middles of their edges; their number, but of those that lie
  /// there.
  std::size_t straighten(const std::vector<std::int32_t>& triangles) {
    std::size_t moved = 0;
    for (const std::int32_t t : triangles) {
      for (const std::int32_t v : surface_.triangles[t]) {
        if (!is_new(v) || straight_[v - before_]) continue;
        straight_[v - before_] = 1;
        const auto& [a, b] = ends_[v - before_];
        surface_.vertices[v] = 0.5 * (surface_.vertices[a] + surface_.vertices[b]);
        ++moved;
      }
    }
    return moved;
  }

  /// These triangles and all that share a vertex with one of them.
  [[nodiscard]] std::vector<std::int32_t> ring(const std::vector<std::int32_t>& triangles) const {
    std::vector<char> near(surface_.vertices.size(), 0);
    for (const std::int32_t t : triangles) {
      for (const std::int32_t v : surface_.triangles[t]) near[v] = 1;
    }
    std::vector<std::int32_t> all;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      const auto& c = surface_.triangles[t];
      if (near[c[0]] || near[c[1]] || near[c[2]]) all.push_back(std::int32_t(t));
    }
    return all;
  }

private:
  [[nodiscard]] bool is_new(std::int32_t v) const { return std::size_t(v) >= before_; }
  void take(std::int32_t v, std::int32_t end) {
    auto& [a, b] = ends_[v - before_];
    if (a < 0 || a == end) {
      a = end;
    } else {
      b = end;
    }
  }

  Surface& surface_;
  std::size_t before_;
  std::vector<std::array<std::int32_t, 2>> ends_;
  std::vector<char> straight_;
};

// Straightens edges until no triangles cross; with all edges straight the surface is the one before the subdivision.
std::size_t straighten_crossings(Surface& surface, std::size_t before) {
  std::size_t kept = 0;
  Halved halved(surface, before);
  for (std::vector<std::int32_t> wrong = geometry::crossing_triangles(surface); !wrong.empty();
       wrong = geometry::crossing_triangles(surface)) {
    std::size_t moved = 0;
    for (std::size_t size = 0; moved == 0 && size < wrong.size();) {
      moved = halved.straighten(wrong);
      size = wrong.size();
      wrong = halved.ring(wrong);
    }
    if (moved == 0) break;
    kept += moved;
  }
  return kept;
}

}  // namespace

Smoothed smooth(const Surface& surface, int rounds) {
  Smoothed result{surface, 0};
  for (int k = 0; k < rounds; ++k) {
    const std::size_t before = result.surface.vertices.size();
    result.surface = subdivided(result.surface);
    result.kept_edges += straighten_crossings(result.surface, before);
  }
  return result;
}

}  // namespace palpate::surface
