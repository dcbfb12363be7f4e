// SPDX-License-Identifier: GPL-3.0-or-later
// Numbering of corners and edge middles, and the boundary faces of a quadratic mesh.
#include "precompute/mesh/volume/quadratic.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace palpate::mesh {
namespace {

// Edges and faces by node positions of a ten-node tetrahedron (tet_mesh.hpp).
constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
constexpr int kFaces[4][6] = {{0, 2, 1, 6, 5, 4}, {0, 1, 3, 4, 8, 7}, {1, 2, 3, 5, 9, 8}, {0, 3, 2, 7, 9, 6}};

struct EdgeUse {
  std::int32_t low, high;
  std::int32_t place;  // 6 * tet + edge
};

struct FaceUse {
  std::array<std::int32_t, 3> key;
  std::int32_t place;  // 4 * tet + face
};

}  // namespace

TetMesh make_quadratic(const LinearTets& linear) {
  TetMesh mesh;
  std::vector<std::int32_t> number(linear.points.size(), -1);
  for (const auto& t : linear.tets) {
    for (const std::int32_t v : t) number[v] = 0;
  }
  for (std::size_t v = 0; v < linear.points.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<std::int32_t>(mesh.nodes.size());
    mesh.nodes.push_back(linear.points[v]);
  }
  mesh.corner_count = static_cast<std::int32_t>(mesh.nodes.size());
  mesh.regions = linear.regions;
  mesh.tets.resize(linear.tets.size());

  std::vector<EdgeUse> edges;
  std::vector<FaceUse> faces;
  for (std::size_t i = 0; i < linear.tets.size(); ++i) {
    auto& nodes = mesh.tets[i];
    for (int k = 0; k < 4; ++k) nodes[k] = number[linear.tets[i][k]];
    for (int k = 0; k < 6; ++k) {
      const auto [low, high] = std::minmax(nodes[kEdges[k][0]], nodes[kEdges[k][1]]);
      edges.push_back({low, high, static_cast<std::int32_t>(6 * i) + k});
    }
    for (int k = 0; k < 4; ++k) {
      std::array<std::int32_t, 3> key{nodes[kFaces[k][0]], nodes[kFaces[k][1]], nodes[kFaces[k][2]]};
      std::sort(key.begin(), key.end());
      faces.push_back({key, static_cast<std::int32_t>(4 * i) + k});
    }
  }
  const auto order = [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.place) < std::tie(b.low, b.high, b.place);
  };
  std::sort(edges.begin(), edges.end(), order);
  // Each edge is known by its first use; middles are numbered in the order of those.
  std::vector<std::int32_t> first(edges.size());
  std::vector<std::int32_t> owner(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool same = i > 0 && edges[i].low == edges[i - 1].low && edges[i].high == edges[i - 1].high;
    first[i] = same ? first[i - 1] : edges[i].place;
    owner[edges[i].place] = first[i];
  }
  std::vector<std::int32_t> middle(edges.size(), -1);
  for (std::size_t place = 0; place < owner.size(); ++place) {
    const std::int32_t use = owner[place];
    auto& nodes = mesh.tets[place / 6];
    const auto& [a, b] = kEdges[place % 6];
    if (middle[use] < 0) {
      middle[use] = static_cast<std::int32_t>(mesh.nodes.size());
      mesh.nodes.push_back((mesh.nodes[nodes[a]] + mesh.nodes[nodes[b]]) / 2);
    }
    nodes[4 + place % 6] = middle[use];
  }

  std::sort(faces.begin(), faces.end(),
            [](const FaceUse& a, const FaceUse& b) { return std::tie(a.key, a.place) < std::tie(b.key, b.place); });
  std::vector<std::int32_t> outer;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const bool before = i > 0 && faces[i - 1].key == faces[i].key;
    const bool after = i + 1 < faces.size() && faces[i + 1].key == faces[i].key;
    if (!before && !after) outer.push_back(faces[i].place);
  }
  std::sort(outer.begin(), outer.end());
  for (const std::int32_t place : outer) {
    std::array<std::int32_t, 6> face{};
    for (int k = 0; k < 6; ++k) face[k] = mesh.tets[place / 4][kFaces[place % 4][k]];
    mesh.faces.push_back(face);
  }
  return mesh;
}

}  // namespace palpate::mesh
