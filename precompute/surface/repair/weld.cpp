// SPDX-License-Identifier: GPL-3.0-or-later
// Deterministic merging by sorting along a line; no hashing, so that equal input gives equal numbering.
#include "precompute/surface/repair/weld.hpp"

#include "precompute/geometry/coincident.hpp"
#include "precompute/geometry/topology.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace palpate::surface {
namespace {

// Rewrites the corners by `to` (vertex -> vertex), drops triangles with repeated corners and unused vertices.
Surface renumber(const Surface& surface, const std::vector<std::int32_t>& to) {
  Surface merged = surface;
  std::vector<bool> keep(surface.triangles.size(), true);
  for (std::size_t i = 0; i < merged.triangles.size(); ++i) {
    auto& t = merged.triangles[i];
    for (auto& vertex : t) vertex = to[std::size_t(vertex)];
    keep[i] = t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
  }
  return keep_triangles(merged, keep);
}

struct BorderVertex {
  std::int32_t vertex = 0;
  std::int32_t part = 0;
  double reach = std::numeric_limits<double>::infinity();  ///< a third of the shortest border edge here
};

std::vector<BorderVertex> border_vertices(const Surface& surface) {
  const auto sides = geometry::sorted_sides(surface);
  std::map<std::int32_t, BorderVertex> found;
  geometry::for_each_edge(sides, [&](auto edge) {
    if (edge.size() > 1) return;
    const auto& side = edge[0];
    const auto length = (surface.vertices[std::size_t(side.low)] - surface.vertices[std::size_t(side.high)]).norm();
    for (const auto vertex : {side.low, side.high}) {
      auto& entry = found[vertex];
      entry.vertex = vertex;
      entry.part = surface.parts[std::size_t(side.triangle)];
      entry.reach = std::min(entry.reach, length / 3);
    }
  });
  std::vector<BorderVertex> result;
  for (const auto& [vertex, entry] : found) result.push_back(entry);
  return result;
}

}  // namespace

Surface weld(const Surface& surface, double tolerance) {
  return renumber(surface, geometry::coincident(surface.vertices, tolerance));
}

Surface join_borders(const Surface& surface, double tolerance) {
  auto border = border_vertices(surface);
  const auto at = [&](const BorderVertex& v) -> const Eigen::Vector3d& {
    return surface.vertices[std::size_t(v.vertex)];
  };
  std::sort(border.begin(), border.end(), [&](const BorderVertex& a, const BorderVertex& b) {
    return geometry::sweep_place(at(a)) != geometry::sweep_place(at(b))
               ? geometry::sweep_place(at(a)) < geometry::sweep_place(at(b))
               : a.vertex < b.vertex;
  });
  // The nearest border vertex of another part; both ways it must be the same pair.
  std::vector<std::size_t> nearest(border.size(), border.size());
  std::vector<double> distance(border.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < border.size(); ++i) {
    for (std::size_t j = i + 1;
         j < border.size() && geometry::sweep_place(at(border[j])) - geometry::sweep_place(at(border[i])) <= tolerance;
         ++j) {
      if (border[i].part == border[j].part) continue;
      const double d = (at(border[i]) - at(border[j])).norm();
      if (d > tolerance || d > border[i].reach || d > border[j].reach) continue;
      if (d < distance[i]) distance[i] = d, nearest[i] = j;
      if (d < distance[j]) distance[j] = d, nearest[j] = i;
    }
  }
  std::vector<std::int32_t> to(surface.vertices.size());
  std::iota(to.begin(), to.end(), 0);
  for (std::size_t i = 0; i < border.size(); ++i) {
    if (nearest[i] == border.size() || nearest[nearest[i]] != i) continue;
    const auto a = border[i].vertex, b = border[nearest[i]].vertex;
    to[std::size_t(std::max(a, b))] = std::min(a, b);
  }
  return renumber(surface, to);
}

Surface drop_duplicates(const Surface& surface) {
  std::map<std::array<std::int32_t, 3>, std::size_t> seen;
  std::vector<bool> keep(surface.triangles.size(), true);
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    auto corners = surface.triangles[i];
    std::sort(corners.begin(), corners.end());
    keep[i] = seen.emplace(corners, i).second;
  }
  return keep_triangles(surface, keep);
}

Surface drop_fins(const Surface& surface) {
  const auto sides = geometry::sorted_sides(surface);
  const auto sheets = geometry::triangle_components(surface, false);
  const auto count = sheets.empty() ? 0 : std::size_t(*std::max_element(sheets.begin(), sheets.end())) + 1;
  std::vector<double> areas(count, 0.0);
  for (std::size_t t = 0; t < sheets.size(); ++t)
    areas[std::size_t(sheets[t])] += geometry::triangle_normal(surface, t).norm() / 2;
  std::vector<bool> open(count, false), hanging(count, false);
  geometry::for_each_edge(sides, [&](auto edge) {
    for (const auto& side : edge) {
      const auto sheet = std::size_t(sheets[std::size_t(side.triangle)]);
      if (edge.size() == 1) open[sheet] = true;
      if (edge.size() > 2) hanging[sheet] = true;
    }
  });
  const double limit = 0.1 * geometry::area(surface);
  std::vector<bool> keep(surface.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) {
    const auto sheet = std::size_t(sheets[t]);
    keep[t] = !(open[sheet] && hanging[sheet] && areas[sheet] < limit);
  }
  return keep_triangles(surface, keep);
}

Surface drop_small_components(const Surface& surface, double share) {
  const auto labels = geometry::triangle_components(surface, true);
  std::vector<double> areas(labels.size(), 0.0);
  for (std::size_t t = 0; t < labels.size(); ++t)
    areas[std::size_t(labels[t])] += geometry::triangle_normal(surface, t).norm() / 2;
  const double limit = share * geometry::area(surface);
  std::vector<bool> keep(labels.size());
  for (std::size_t t = 0; t < labels.size(); ++t) keep[t] = areas[std::size_t(labels[t])] >= limit;
  return keep_triangles(surface, keep);
}

Surface keep_triangles(const Surface& surface, const std::vector<bool>& keep) {
  Surface kept;
  kept.part_names = surface.part_names;
  std::vector<bool> used(surface.vertices.size(), false);
  for (std::size_t t = 0; t < keep.size(); ++t) {
    if (!keep[t]) continue;
    for (const auto vertex : surface.triangles[t]) used[std::size_t(vertex)] = true;
    kept.triangles.push_back(surface.triangles[t]);
    kept.parts.push_back(surface.parts[t]);
  }
  std::vector<std::int32_t> number(surface.vertices.size(), -1);
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    number[v] = std::int32_t(kept.vertices.size());
    kept.vertices.push_back(surface.vertices[v]);
  }
  for (auto& triangle : kept.triangles) {
    for (auto& vertex : triangle) vertex = number[std::size_t(vertex)];
  }
  return kept;
}

Surface join(const std::vector<Surface>& surfaces) {
  Surface all;
  for (const auto& surface : surfaces) {
    all.frame = surface.frame;
    all.notes.insert(all.notes.end(), surface.notes.begin(), surface.notes.end());
    const auto vertex = std::int32_t(all.vertices.size());
    const auto part = std::int32_t(all.part_names.size());
    all.vertices.insert(all.vertices.end(), surface.vertices.begin(), surface.vertices.end());
    all.part_names.insert(all.part_names.end(), surface.part_names.begin(), surface.part_names.end());
    for (const auto& t : surface.triangles) all.triangles.push_back({t[0] + vertex, t[1] + vertex, t[2] + vertex});
    for (const auto label : surface.parts) all.parts.push_back(label + part);
  }
  return all;
}

}  // namespace palpate::surface
