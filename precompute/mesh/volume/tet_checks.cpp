// SPDX-License-Identifier: GPL-3.0-or-later
// Orientation, boundary, regions and angles of linear tetrahedra.
#include "precompute/mesh/volume/tet_checks.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;
using Triangle = std::array<std::int32_t, 3>;

// Faces of a positive tetrahedron, counter-clockwise from outside.
constexpr int kTriangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

double six_volumes(const LinearTets& m, const std::array<std::int32_t, 4>& t) {
  const Vector3d& a = m.points[t[0]];
  return (m.points[t[1]] - a).cross(m.points[t[2]] - a).dot(m.points[t[3]] - a);
}

Triangle sorted(Triangle t) {
  std::sort(t.begin(), t.end());
  return t;
}

// True when an even permutation of `t` is sorted.
bool even(const Triangle& t) {
  return (t[0] < t[1] && t[1] < t[2]) || (t[1] < t[2] && t[2] < t[0]) || (t[2] < t[0] && t[0] < t[1]);
}

struct TetFace {
  Triangle key;
  std::int32_t tet;
  bool even;
};

struct WallFace {
  Triangle key;
  std::int32_t surface;  // 0 outer, k the k-th inclusion
  bool even;
  int found = 0;
};

const char* kOutside = "the boundary of the tetrahedra is not the surface";

// Beside the regions' own numbers: not known yet, and on the outer side of the surface (inside a cavity).
constexpr std::int32_t kUnknown = -1, kVoid = -2;

// Takes the tetrahedra of cavities out, and the points that only they had.
void drop_voids(LinearTets& mesh) {
  if (std::find(mesh.regions.begin(), mesh.regions.end(), kVoid) == mesh.regions.end()) return;
  std::size_t kept = 0;
  std::vector<std::int32_t> number(mesh.points.size(), kUnknown);
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
    if (mesh.regions[i] == kVoid) continue;
    for (const std::int32_t v : mesh.tets[i]) number[v] = 0;
    mesh.tets[kept] = mesh.tets[i];
    mesh.regions[kept++] = mesh.regions[i];
  }
  mesh.tets.resize(kept);
  mesh.regions.resize(kept);
  std::int32_t points = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kUnknown) continue;
    mesh.points[points] = mesh.points[v];
    number[v] = points++;
  }
  mesh.points.resize(points);
  for (auto& t : mesh.tets) {
    for (std::int32_t& v : t) v = number[v];
  }
}

}  // namespace

std::string orient_tets(LinearTets& mesh) {
  if (mesh.tets.empty()) return "no tetrahedra";
  const auto count = static_cast<std::int32_t>(mesh.points.size());
  for (auto& t : mesh.tets) {
    for (const std::int32_t v : t) {
      if (v < 0 || v >= count) return "a tetrahedron has a corner out of range";
    }
    double volume = six_volumes(mesh, t);
    if (volume < 0) {
      std::swap(t[2], t[3]);
      volume = -volume;
    }
    double longest = 0;
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) longest = std::max(longest, (mesh.points[t[i]] - mesh.points[t[j]]).norm());
    }
    if (!(volume > 1e-9 * longest * longest * longest)) return "a tetrahedron is flat";
  }
  return {};
}

std::string find_regions(LinearTets& mesh, const SurfaceTriangles& outer, const std::vector<SurfaceTriangles>& inner) {
  std::vector<WallFace> walls;
  const auto add_walls = [&](const SurfaceTriangles& triangles, std::int32_t surface) {
    for (const Triangle& t : triangles) walls.push_back({sorted(t), surface, even(t)});
  };
  add_walls(outer, 0);
  for (std::size_t k = 0; k < inner.size(); ++k) add_walls(inner[k], static_cast<std::int32_t>(k + 1));
  const auto by_key = [](const auto& a, const auto& b) { return a.key < b.key; };
  std::sort(walls.begin(), walls.end(), by_key);

  std::vector<TetFace> faces;
  faces.reserve(mesh.tets.size() * 4);
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
    for (const auto& f : kTriangles) {
      const Triangle t{mesh.tets[i][f[0]], mesh.tets[i][f[1]], mesh.tets[i][f[2]]};
      faces.push_back({sorted(t), static_cast<std::int32_t>(i), even(t)});
    }
  }
  std::stable_sort(faces.begin(), faces.end(), by_key);

  // Neighbours across faces that are no wall; what a wall says about the tetrahedra at it.
  std::vector<std::array<std::int32_t, 2>> joined;
  mesh.regions.assign(mesh.tets.size(), kUnknown);
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].key == faces[i].key) ++end;
    if (end - i > 2) return "three tetrahedra share a face";
    const auto wall = std::lower_bound(walls.begin(), walls.end(), faces[i], by_key);
    const bool is_wall = wall != walls.end() && wall->key == faces[i].key;
    if (is_wall) ++wall->found;
    if (end - i == 1) {
      if (!is_wall || wall->surface != 0 || wall->even != faces[i].even) return kOutside;
    } else if (!is_wall) {
      joined.push_back({faces[i].tet, faces[i + 1].tet});
    }
    if (is_wall) {
      for (std::size_t j = i; j < end; ++j) {
        const std::int32_t beyond = wall->surface == 0 ? kVoid : 0;
        const std::int32_t region = faces[j].even == wall->even ? wall->surface : beyond;
        std::int32_t& known = mesh.regions[faces[j].tet];
        if (known != kUnknown && known != region) return "a tetrahedron lies in two regions";
        known = region;
      }
    }
    i = end;
  }
  for (const WallFace& w : walls) {
    if (w.found == 0) return w.surface == 0 ? kOutside : "an inclusion's triangle is missing from the tetrahedra";
  }

  // Flood the regions from the walls.
  std::vector<std::vector<std::int32_t>> neighbours(mesh.tets.size());
  for (const auto& [a, b] : joined) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  std::vector<std::int32_t> front;
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
    if (mesh.regions[i] != kUnknown) front.push_back(static_cast<std::int32_t>(i));
  }
  while (!front.empty()) {
    const std::int32_t at = front.back();
    front.pop_back();
    for (const std::int32_t next : neighbours[at]) {
      if (mesh.regions[next] == kUnknown) {
        mesh.regions[next] = mesh.regions[at];
        front.push_back(next);
      } else if (mesh.regions[next] != mesh.regions[at]) {
        return "two regions leak into each other";
      }
    }
  }
  if (std::find(mesh.regions.begin(), mesh.regions.end(), kUnknown) != mesh.regions.end()) {
    return "tetrahedra that touch no surface";
  }
  drop_voids(mesh);
  return mesh.tets.empty() ? kOutside : std::string();
}

double min_dihedral(const LinearTets& mesh) {
  double largest_cosine = -1;
  for (const auto& t : mesh.tets) {
    std::array<Vector3d, 4> normal;
    for (int f = 0; f < 4; ++f) {
      const Vector3d& a = mesh.points[t[kTriangles[f][0]]];
      normal[f] = (mesh.points[t[kTriangles[f][1]]] - a).cross(mesh.points[t[kTriangles[f][2]]] - a).normalized();
    }
    for (int i = 0; i < 4; ++i) {
      // Outward normals: the angle between the faces is 180 degrees less theirs.
      for (int j = i + 1; j < 4; ++j) largest_cosine = std::max(largest_cosine, -normal[i].dot(normal[j]));
    }
  }
  return std::acos(std::clamp(largest_cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
}

std::vector<double> region_volumes(const LinearTets& mesh, std::size_t inclusions) {
  std::vector<double> volumes(inclusions + 1, 0.0);
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) volumes[mesh.regions[i]] += six_volumes(mesh, mesh.tets[i]) / 6;
  return volumes;
}

}  // namespace palpate::mesh
