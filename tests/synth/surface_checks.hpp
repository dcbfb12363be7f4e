// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of a triangle surface that the tests compare with known values.
#pragma once

#include "formats/surface/surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace palpate::test {

/// Number of directed edges that are there twice or lack their opposite: 0 for a closed, oriented 2-manifold
/// (but for vertices that two fans share).
inline int edge_faults(const Surface& s) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const auto& t : s.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  }
  int faults = 0;
  for (const auto& [edge, count] : edges) {
    if (count != 1 || edges.count({edge.second, edge.first}) == 0) ++faults;
  }
  return faults;
}

/// V - E + F of a closed surface: 2 for one sphere-like piece.
inline int euler(const Surface& s) {
  return static_cast<int>(s.vertices.size()) - static_cast<int>(s.triangles.size()) * 3 / 2 +
         static_cast<int>(s.triangles.size());
}

inline std::array<Eigen::Vector3d, 3> corners(const Surface& s, const std::array<std::int32_t, 3>& t) {
  return {s.vertices[static_cast<std::size_t>(t[0])], s.vertices[static_cast<std::size_t>(t[1])],
          s.vertices[static_cast<std::size_t>(t[2])]};
}

/// Positive for outward triangles (m^3).
inline double volume(const Surface& s) {
  double sum = 0;
  for (const auto& t : s.triangles) {
    const auto [a, b, c] = corners(s, t);
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

/// Smallest angle of any triangle (degrees).
inline double smallest_angle(const Surface& s) {
  double smallest = 180;
  for (const auto& t : s.triangles) {
    const auto p = corners(s, t);
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
      smallest = std::min(smallest, std::atan2(u.cross(v).norm(), u.dot(v)) * 180 / 3.14159265358979);
    }
  }
  return smallest;
}

/// Mean edge length (m).
inline double mean_edge(const Surface& s) {
  double sum = 0;
  for (const auto& t : s.triangles) {
    const auto p = corners(s, t);
    for (std::size_t k = 0; k < 3; ++k) sum += (p[(k + 1) % 3] - p[k]).norm();
  }
  return sum / (3.0 * static_cast<double>(s.triangles.size()));
}

}  // namespace palpate::test
