// SPDX-License-Identifier: GPL-3.0-or-later
// Generators by subdivision and revolution; shared vertices by construction, not by welding.
#include "precompute/geometry/solids.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace palpate::geometry {

namespace {

using std::numbers::pi;

void finish(Surface& surface, const std::string& name) {
  surface.parts.assign(surface.triangles.size(), 0);
  surface.part_names = {name};
}

std::int32_t add_vertex(Surface& surface, const Eigen::Vector3d& point) {
  surface.vertices.push_back(point);
  return static_cast<std::int32_t>(surface.vertices.size() - 1);
}

Surface icosahedron() {
  const double g = std::numbers::phi;
  Surface s;
  for (const auto& [x, y, z] : std::array<std::array<double, 3>, 12>{{{-1, g, 0},
                                                                      {1, g, 0},
                                                                      {-1, -g, 0},
                                                                      {1, -g, 0},
                                                                      {0, -1, g},
                                                                      {0, 1, g},
                                                                      {0, -1, -g},
                                                                      {0, 1, -g},
                                                                      {g, 0, -1},
                                                                      {g, 0, 1},
                                                                      {-g, 0, -1},
                                                                      {-g, 0, 1}}}) {
    s.vertices.emplace_back(Eigen::Vector3d(x, y, z).normalized());
  }
  s.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return s;
}

}  // namespace

Surface geodesic_sphere(int frequency, const std::string& name) {
  const Surface coarse = icosahedron();
  Surface s;
  s.vertices = coarse.vertices;
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::int32_t>> edges;
  // Vertices of an edge from `from` to `to`, ends included; made once for both its faces.
  const auto edge = [&](std::int32_t from, std::int32_t to) {
    const auto key = std::minmax(from, to);
    auto [entry, is_new] = edges.try_emplace(key);
    if (is_new) {
      entry->second.push_back(key.first);
      for (int i = 1; i < frequency; ++i) {
        const double t = static_cast<double>(i) / frequency;
        const Eigen::Vector3d& a = coarse.vertices[static_cast<std::size_t>(key.first)];
        const Eigen::Vector3d& b = coarse.vertices[static_cast<std::size_t>(key.second)];
        entry->second.push_back(add_vertex(s, ((1 - t) * a + t * b).normalized()));
      }
      entry->second.push_back(key.second);
    }
    std::vector<std::int32_t> vertices = entry->second;
    if (from > to) std::reverse(vertices.begin(), vertices.end());
    return vertices;
  };
  for (const auto& [a, b, c] : coarse.triangles) {
    const auto left = edge(a, b);  // row r begins at left[r] and ends at right[r]
    const auto right = edge(a, c);
    const auto bottom = edge(b, c);
    std::vector<std::int32_t> above{a};
    for (int row = 1; row <= frequency; ++row) {
      const auto r = static_cast<std::size_t>(row);
      std::vector<std::int32_t> below{left[r]};
      for (int column = 1; column < row; ++column) {
        if (row == frequency) {
          below.push_back(bottom[static_cast<std::size_t>(column)]);
          continue;
        }
        const double v = static_cast<double>(row - column) / frequency, w = static_cast<double>(column) / frequency;
        const Eigen::Vector3d point = (1 - v - w) * coarse.vertices[static_cast<std::size_t>(a)] +
                                      v * coarse.vertices[static_cast<std::size_t>(b)] +
                                      w * coarse.vertices[static_cast<std::size_t>(c)];
        below.push_back(add_vertex(s, point.normalized()));
      }
      below.push_back(right[r]);
      for (std::size_t i = 0; i < above.size(); ++i) {
        s.triangles.push_back({above[i], below[i], below[i + 1]});
        if (i + 1 < above.size()) s.triangles.push_back({above[i], below[i + 1], above[i + 1]});
      }
      above = below;
    }
  }
  finish(s, name);
  return s;
}

int geodesic_frequency(double area, double edge) {
  // An equilateral triangle of edge e has the area sqrt(3)/4 e^2.
  const double triangles = area / (std::sqrt(3.0) / 4 * edge * edge);
  return std::max(2, static_cast<int>(std::lround(std::sqrt(triangles / 20))));
}

Surface ellipsoid(const Eigen::Vector3d& centre, const Eigen::Vector3d& semi_axes, double edge,
                  const std::string& name) {
  // Knud Thomsen's approximation of the area, within 1.1 %.
  const Eigen::Vector3d p = semi_axes.array().pow(1.6075);
  const double mean = (p.x() * p.y() + p.x() * p.z() + p.y() * p.z()) / 3;
  Surface s = geodesic_sphere(geodesic_frequency(4 * pi * std::pow(mean, 1 / 1.6075), edge), name);
  for (Eigen::Vector3d& v : s.vertices) v = centre + v.cwiseProduct(semi_axes);
  return s;
}

Surface box_solid(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double edge, const std::string& name) {
  const Eigen::Vector3d size = high - low;
  const Eigen::Array3i count = (size.array() / edge).round().max(1.0).cast<int>();
  Surface s;
  std::map<std::array<int, 3>, std::int32_t> index;  // by lattice place, so that faces share their rims
  const auto vertex = [&](const Eigen::Array3i& place) {
    auto [entry, is_new] = index.try_emplace({place.x(), place.y(), place.z()}, 0);
    if (is_new) {
      const Eigen::Array3d share = place.cast<double>() / count.cast<double>();
      entry->second = add_vertex(s, low + (size.array() * share).matrix());
    }
    return entry->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const int side : {0, count[axis]}) {
      for (int i = 0; i < count[u]; ++i) {
        for (int j = 0; j < count[v]; ++j) {
          std::array<std::int32_t, 4> corner{};
          for (int k = 0; k < 4; ++k) {
            Eigen::Array3i place;
            place[axis] = side;
            place[u] = i + (k == 1 || k == 2 ? 1 : 0);
            place[v] = j + (k >= 2 ? 1 : 0);
            corner[static_cast<std::size_t>(k)] = vertex(place);
          }
          if (side == 0) std::swap(corner[1], corner[3]);  // seen from outside
          // Diagonals alternate, so that the triangulation prefers no direction.
          if ((i + j) % 2 == 0) {
            s.triangles.push_back({corner[0], corner[1], corner[2]});
            s.triangles.push_back({corner[0], corner[2], corner[3]});
          } else {
            s.triangles.push_back({corner[1], corner[2], corner[3]});
            s.triangles.push_back({corner[1], corner[3], corner[0]});
          }
        }
      }
    }
  }
  finish(s, name);
  return s;
}

Surface revolved(const std::vector<ProfilePoint>& profile, int segments, const std::string& name) {
  Surface s;
  const auto n = static_cast<std::int32_t>(segments);
  const std::int32_t bottom = add_vertex(s, {0, 0, profile.front().z});
  for (std::size_t ring = 1; ring + 1 < profile.size(); ++ring) {
    for (int k = 0; k < segments; ++k) {
      const double angle = 2 * pi * k / segments;
      add_vertex(s, {profile[ring].radius * std::cos(angle), profile[ring].radius * std::sin(angle), profile[ring].z});
    }
  }
  const std::int32_t top = add_vertex(s, {0, 0, profile.back().z});
  const auto rings = static_cast<std::int32_t>(profile.size()) - 2;
  const auto at = [&](std::int32_t ring, std::int32_t k) { return 1 + ring * n + k % n; };
  for (std::int32_t k = 0; k < n; ++k) {
    s.triangles.push_back({bottom, at(0, k + 1), at(0, k)});
    for (std::int32_t ring = 0; ring + 1 < rings; ++ring) {
      s.triangles.push_back({at(ring, k), at(ring, k + 1), at(ring + 1, k + 1)});
      s.triangles.push_back({at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)});
    }
    s.triangles.push_back({at(rings - 1, k), at(rings - 1, k + 1), top});
  }
  finish(s, name);
  return s;
}

}  // namespace palpate::geometry
