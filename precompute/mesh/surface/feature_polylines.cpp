// SPDX-License-Identifier: GPL-3.0-or-later
// Walks the graph of feature edges from corner to corner.
#include "precompute/mesh/surface/feature_polylines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace palpate::mesh {

using Eigen::Vector3d;

std::vector<std::vector<Vector3d>> feature_polylines(const geometry::SurfaceQuery& query,
                                                     const std::vector<Vector3d>& stops) {
  std::vector<Vector3d> points = query.surface().vertices;
  std::vector<std::array<std::int32_t, 2>> edges = query.feature_edges();
  std::vector<char> stop(points.size(), 0);
  double scale = 0;
  for (const Vector3d& p : points) scale = std::max(scale, (p - points[0]).norm());
  const double close = 1e-9 * scale;

  // A stop on an edge cuts it in two; one at a vertex marks it.
  for (const Vector3d& s : stops) {
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const auto [a, b] = edges[e];
      const Vector3d along = points[b] - points[a];
      const double t = (s - points[a]).dot(along) / along.squaredNorm();
      if (t < 0 || t > 1 || (points[a] + t * along - s).norm() > close) continue;
      if ((s - points[a]).norm() <= close) {
        stop[a] = 1;
      } else if ((s - points[b]).norm() <= close) {
        stop[b] = 1;
      } else {
        const auto cut = static_cast<std::int32_t>(points.size());
        points.push_back(s);
        stop.push_back(1);
        edges[e] = {a, cut};
        edges.push_back({cut, b});
      }
      break;
    }
  }

  std::vector<std::vector<std::int32_t>> at(points.size());  // edges of each vertex
  for (std::size_t e = 0; e < edges.size(); ++e) {
    for (const std::int32_t v : edges[e]) at[v].push_back(static_cast<std::int32_t>(e));
  }
  const auto other = [&](std::int32_t e, std::int32_t v) { return edges[e][0] == v ? edges[e][1] : edges[e][0]; };
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (at[v].empty() || stop[v]) continue;
    if (at[v].size() != 2) {
      stop[v] = 1;
      continue;
    }
    const Vector3d u = (points[other(at[v][0], static_cast<std::int32_t>(v))] - points[v]).normalized();
    const Vector3d w = (points[other(at[v][1], static_cast<std::int32_t>(v))] - points[v]).normalized();
    stop[v] = -u.dot(w) < std::cos(40 * std::numbers::pi / 180) ? 1 : 0;
  }

  std::vector<char> used(edges.size(), 0);
  std::vector<std::vector<Vector3d>> lines;
  const auto walk = [&](std::int32_t from, std::int32_t e) {
    std::vector<Vector3d> line{points[from]};
    std::int32_t v = from;
    while (e >= 0) {
      used[e] = 1;
      v = other(e, v);
      line.push_back(points[v]);
      if (stop[v] || v == from) break;
      e = used[at[v][0]] ? (used[at[v][1]] ? -1 : at[v][1]) : at[v][0];
    }
    lines.push_back(std::move(line));
  };
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (!stop[v]) continue;
    for (const std::int32_t e : at[v]) {
      if (!used[e]) walk(static_cast<std::int32_t>(v), e);
    }
  }
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (!used[e]) walk(edges[e][0], static_cast<std::int32_t>(e));
  }
  return lines;
}

}  // namespace palpate::mesh
