// SPDX-License-Identifier: GPL-3.0-or-later
// Closed triangle surfaces with known answers: box, ball, and what the tests do to them.
#pragma once

#include "formats/surface/surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace palpate::test {

/// A surface of one part called `name`.
inline void set_one_part(Surface& surface, const char* name) {
  surface.parts.assign(surface.triangles.size(), 0);
  surface.part_names = {name};
}

/// Axis-aligned box (m), every face `n` x `n` squares of two triangles, outward, shared vertices.
inline Surface box_surface(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int n = 1) {
  Surface s;
  std::map<std::array<int, 3>, std::int32_t> ids;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [found, fresh] = ids.try_emplace(at, static_cast<std::int32_t>(s.vertices.size()));
    if (fresh) {
      Eigen::Vector3d p;
      for (int k = 0; k < 3; ++k) p[k] = at[k] == n ? high[k] : low[k] + (high[k] - low[k]) * at[k] / n;
      s.vertices.push_back(p);
    }
    return found->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const int side : {0, n}) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const auto at = [&](int a, int b) {
            std::array<int, 3> p{};
            p[axis] = side, p[u] = a, p[v] = b;
            return vertex(p);
          };
          const std::int32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
          if (side == 0) {
            s.triangles.push_back({a, c, b});
            s.triangles.push_back({a, d, c});
          } else {
            s.triangles.push_back({a, b, c});
            s.triangles.push_back({a, c, d});
          }
        }
      }
    }
  }
  set_one_part(s, "box");
  return s;
}

/// Icosahedron subdivided `levels` times with all vertices on the sphere: 20 * 4^levels triangles, outward.
inline Surface sphere_surface(const Eigen::Vector3d& centre, double radius, int levels = 3) {
  Surface s;
  const double g = (1 + std::sqrt(5.0)) / 2;
  const double p[12][3] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                           {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (const auto& v : p) s.vertices.push_back(Eigen::Vector3d(v[0], v[1], v[2]).normalized());
  s.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [found, fresh] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<std::int32_t>(s.vertices.size()));
      if (fresh) s.vertices.push_back((s.vertices[a] + s.vertices[b]).normalized());
      return found->second;
    };
    std::vector<std::array<std::int32_t, 3>> finer;
    for (const auto& t : s.triangles) {
      const std::int32_t a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], a, c}, {t[1], b, a}, {t[2], c, b}, {a, b, c}});
    }
    s.triangles = std::move(finer);
  }
  for (Eigen::Vector3d& v : s.vertices) v = centre + radius * v;
  set_one_part(s, "ball");
  return s;
}

/// Volume inside a closed surface (m^3).
inline double surface_volume(const Surface& s) {
  double six = 0;
  for (const auto& t : s.triangles) {
    six += s.vertices[t[0]].dot(s.vertices[t[1]].cross(s.vertices[t[2]]));
  }
  return six / 6;
}

/// True when every edge has exactly one triangle on either side: closed, manifold edges, one orientation.
inline bool closed_and_oriented(const Surface& s) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const auto& t : s.triangles) {
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  }
  return !edges.empty() && std::all_of(edges.begin(), edges.end(), [&](const auto& e) {
    return e.second == 1 && edges.count({e.first.second, e.first.first}) == 1;
  });
}

}  // namespace palpate::test
