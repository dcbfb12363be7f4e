// SPDX-License-Identifier: GPL-3.0-or-later
// Splitting of edges and vertices in which parts of a solid touch.
#include "precompute/geometry/topology.hpp"
#include "precompute/surface/repair/weld.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::surface {
namespace {

using Eigen::Vector3d;

constexpr double kApart = 0.01;  // of the shortest edge at a copied vertex

std::size_t corner_of(const Surface& surface, std::int32_t triangle, std::int32_t vertex) {
  const auto& t = surface.triangles[std::size_t(triangle)];
  return 3 * std::size_t(triangle) + std::size_t(std::find(t.begin(), t.end(), vertex) - t.begin());
}

// A side with the angle of its triangle about the edge, from the low to the high vertex.
struct Leaf {
  geometry::TriangleSide side;
  double angle = 0;
};

}  // namespace

Split split_touching(const Surface& surface) {
  Split split;
  split.surface = surface;
  const auto sides = geometry::sorted_sides(surface);
  geometry::Sets fans(3 * surface.triangles.size());
  bool paired = true;
  const auto join = [&](const geometry::TriangleSide& a, const geometry::TriangleSide& b) {
    for (const auto vertex : {a.low, a.high}) {
      fans.join(corner_of(surface, a.triangle, vertex), corner_of(surface, b.triangle, vertex));
    }
  };
  geometry::for_each_edge(sides, [&](auto edge) {
    if (edge.size() == 2) join(edge[0], edge[1]);
    if (edge.size() < 3) return;
    ++split.edges;
    const Vector3d& low = surface.vertices[std::size_t(edge[0].low)];
    const Vector3d axis = (surface.vertices[std::size_t(edge[0].high)] - low).normalized();
    const Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
    std::vector<Leaf> leaves;
    for (const geometry::TriangleSide& side : edge) {
      Vector3d d(0, 0, 0);
      for (const auto corner : surface.triangles[std::size_t(side.triangle)]) {
        if (corner != side.low && corner != side.high) d = surface.vertices[std::size_t(corner)] - low;
      }
      leaves.push_back({side, std::atan2(d.dot(v), d.dot(u))});
    }
    std::stable_sort(leaves.begin(), leaves.end(), [](const Leaf& a, const Leaf& b) { return a.angle < b.angle; });
    const std::size_t n = leaves.size();
    for (std::size_t k = 0; k < n; ++k) {
      if (!leaves[k].side.forward) continue;
      // Outside lies at larger angles than a forward triangle: the solid is between it and the one before.
      const Leaf& other = leaves[(k + n - 1) % n];
      if (other.side.forward) paired = false;
      join(leaves[k].side, other.side);
    }
    const auto forward = std::count_if(leaves.begin(), leaves.end(), [](const Leaf& l) { return l.side.forward; });
    if (2 * std::size_t(forward) != n) paired = false;
  });
  if (!paired) return {surface, 0, 0};
  // The first fan of a vertex keeps its number; every other gets a copy.
  Surface& result = split.surface;
  std::vector<std::int64_t> first(surface.vertices.size(), -1);
  std::vector<std::int32_t> number(3 * surface.triangles.size(), -1);
  std::vector<char> copied(surface.vertices.size(), 0);
  for (std::size_t corner = 0; corner < number.size(); ++corner) {
    const auto vertex = std::size_t(surface.triangles[corner / 3][corner % 3]);
    const std::size_t fan = fans.find(corner);
    if (first[vertex] < 0) first[vertex] = std::int64_t(fan);
    if (number[fan] < 0) {
      if (first[vertex] == std::int64_t(fan)) {
        number[fan] = std::int32_t(vertex);
      } else {
        number[fan] = std::int32_t(result.vertices.size());
        result.vertices.push_back(surface.vertices[vertex]);
        copied.push_back(1);
        if (copied[vertex] == 0) ++split.vertices;
        copied[vertex] = 1;
      }
    }
    result.triangles[corner / 3][corner % 3] = number[fan];
  }
  std::vector<Vector3d> into(result.vertices.size(), Vector3d::Zero());
  std::vector<double> shortest(result.vertices.size(), std::numeric_limits<double>::infinity());
  for (std::size_t t = 0; t < result.triangles.size(); ++t) {
    const auto& c = result.triangles[t];
    const Vector3d inward = -geometry::triangle_normal(result, t).stableNormalized();
    for (std::size_t k = 0; k < 3; ++k) {
      if (copied[std::size_t(c[k])] == 0) continue;
      into[std::size_t(c[k])] += inward;
      for (const std::size_t o : {(k + 1) % 3, (k + 2) % 3}) {
        const Vector3d edge = surface.vertices[std::size_t(surface.triangles[t][o])] -
                              surface.vertices[std::size_t(surface.triangles[t][k])];
        shortest[std::size_t(c[k])] = std::min(shortest[std::size_t(c[k])], edge.norm());
      }
    }
  }
  for (std::size_t v = 0; v < into.size(); ++v) {
    if (copied[v] != 0) result.vertices[v] += kApart * shortest[v] * into[v].stableNormalized();
  }
  return split;
}

}  // namespace palpate::surface
