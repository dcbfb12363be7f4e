// SPDX-License-Identifier: GPL-3.0-or-later
// Edge sorting and union-find; every result depends on the indices alone.
#include "precompute/geometry/topology.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <tuple>

namespace palpate::geometry {
namespace {

const Eigen::Vector3d& corner(const Surface& surface, std::size_t triangle, std::size_t k) {
  return surface.vertices[std::size_t(surface.triangles[triangle][k])];
}

std::size_t corner_at(const Surface& surface, std::int32_t triangle, std::int32_t vertex) {
  const auto& t = surface.triangles[std::size_t(triangle)];
  return 3 * std::size_t(triangle) + std::size_t(std::find(t.begin(), t.end(), vertex) - t.begin());
}

// Vertices around which the triangles form more than one fan.
std::size_t count_nonmanifold_vertices(const Surface& surface, const std::vector<TriangleSide>& sides) {
  Sets fans(3 * surface.triangles.size());
  for_each_edge(sides, [&](auto edge) {
    for (const auto& side : edge.subspan(1)) {
      for (const auto vertex : {side.low, side.high}) {
        fans.join(corner_at(surface, edge[0].triangle, vertex), corner_at(surface, side.triangle, vertex));
      }
    }
  });
  std::vector<std::int64_t> fan_of(surface.vertices.size(), -1);
  std::vector<bool> several(surface.vertices.size(), false);
  for (const auto& side : sides) {
    for (const auto vertex : {side.low, side.high}) {
      const auto fan = std::int64_t(fans.find(corner_at(surface, side.triangle, vertex)));
      auto& known = fan_of[std::size_t(vertex)];
      if (known >= 0 && known != fan) several[std::size_t(vertex)] = true;
      if (known < 0) known = fan;
    }
  }
  return std::size_t(std::count(several.begin(), several.end(), true));
}

std::size_t count_duplicates(const Surface& surface) {
  auto sorted = surface.triangles;
  for (auto& t : sorted) std::sort(t.begin(), t.end());
  std::sort(sorted.begin(), sorted.end());
  return std::size_t(sorted.end() - std::unique(sorted.begin(), sorted.end()));
}

std::size_t count_loops(const Surface& surface, const std::vector<TriangleSide>& sides) {
  Sets loops(surface.vertices.size());
  std::vector<bool> on_boundary(surface.vertices.size(), false);
  for_each_edge(sides, [&](auto edge) {
    if (edge.size() != 1) return;
    loops.join(std::size_t(edge[0].low), std::size_t(edge[0].high));
    on_boundary[std::size_t(edge[0].low)] = on_boundary[std::size_t(edge[0].high)] = true;
  });
  std::size_t count = 0;
  for (std::size_t v = 0; v < on_boundary.size(); ++v) count += on_boundary[v] && loops.find(v) == v;
  return count;
}

}  // namespace

Sets::Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

std::size_t Sets::find(std::size_t item) {
  while (parent_[item] != item) item = parent_[item] = parent_[parent_[item]];
  return item;
}

void Sets::join(std::size_t a, std::size_t b) {
  a = find(a);
  b = find(b);
  parent_[std::max(a, b)] = std::min(a, b);
}

std::vector<TriangleSide> sorted_sides(const Surface& surface) {
  std::vector<TriangleSide> sides;
  sides.reserve(3 * surface.triangles.size());
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& t = surface.triangles[i];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto from = t[k], to = t[(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), std::int32_t(i), from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const TriangleSide& a, const TriangleSide& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return sides;
}

Topology topology(const Surface& surface) {
  Topology result;
  const auto sides = sorted_sides(surface);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) result.degenerate += is_degenerate(surface, t);
  result.duplicates = count_duplicates(surface);
  for_each_edge(sides, [&](auto edge) {
    if (edge.size() == 1) ++result.boundary_edges;
    if (edge.size() > 2) ++result.nonmanifold_edges;
    if (edge.size() == 2) result.flipped_edges += edge[0].forward == edge[1].forward;
  });
  result.boundary_loops = count_loops(surface, sides);
  result.nonmanifold_vertices = count_nonmanifold_vertices(surface, sides);
  const auto labels = triangle_components(surface, true);
  result.components = labels.empty() ? 0 : std::size_t(*std::max_element(labels.begin(), labels.end())) + 1;
  return result;
}

std::vector<std::int32_t> triangle_components(const Surface& surface, bool over_nonmanifold_edges) {
  const auto sides = sorted_sides(surface);
  Sets sets(surface.triangles.size());
  for_each_edge(sides, [&](auto edge) {
    if (edge.size() > 2 && !over_nonmanifold_edges) return;
    for (const auto& side : edge.subspan(1)) sets.join(std::size_t(edge[0].triangle), std::size_t(side.triangle));
  });
  std::vector<std::int32_t> labels(surface.triangles.size(), -1);
  std::int32_t count = 0;
  for (std::size_t t = 0; t < labels.size(); ++t) {
    const auto root = sets.find(t);
    labels[t] = root == t ? count++ : labels[root];  // the representative is the first of its set
  }
  return labels;
}

bool is_degenerate(const Surface& surface, std::size_t triangle) {
  const auto& a = corner(surface, triangle, 0);
  const auto& b = corner(surface, triangle, 1);
  const auto& c = corner(surface, triangle, 2);
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return !(triangle_normal(surface, triangle).norm() > 1e-10 * longest);
}

Eigen::Vector3d triangle_normal(const Surface& surface, std::size_t triangle) {
  const auto& a = corner(surface, triangle, 0);
  return (corner(surface, triangle, 1) - a).cross(corner(surface, triangle, 2) - a);
}

double signed_volume(const Surface& surface) {
  if (surface.empty()) return 0.0;
  // Relative to a point of the surface: far from the origin the terms would cancel.
  const auto origin = corner(surface, 0, 0);
  double six = 0.0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Eigen::Vector3d a = corner(surface, t, 0) - origin;
    const Eigen::Vector3d b = corner(surface, t, 1) - origin;
    six += a.dot(b.cross(corner(surface, t, 2) - origin));
  }
  return six / 6.0;
}

double area(const Surface& surface) {
  double twice = 0.0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) twice += triangle_normal(surface, t).norm();
  return twice / 2.0;
}

double diagonal(const Surface& surface) {
  Eigen::AlignedBox3d box;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) box.extend(corner(surface, t, k));
  }
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

}  // namespace palpate::geometry
