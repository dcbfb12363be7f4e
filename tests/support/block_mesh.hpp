// SPDX-License-Identifier: GPL-3.0-or-later
// Rectilinear block of quadratic tetrahedra with chosen grid lines: an exact geometry for element tests.
#pragma once

#include "precompute/mesh/tet_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

namespace palpate::test {

/// Six tetrahedra a cell (Kuhn's subdivision, so that neighbours match); all node positions exact.
inline mesh::TetMesh block_mesh(const std::vector<double>& xs, const std::vector<double>& ys,
                                const std::vector<double>& zs) {
  mesh::TetMesh mesh;
  const auto nx = static_cast<int>(xs.size()), ny = static_cast<int>(ys.size()), nz = static_cast<int>(zs.size());
  const auto id = [&](int i, int j, int k) { return (k * ny + j) * nx + i; };
  for (const double z : zs) {
    for (const double y : ys) {
      for (const double x : xs) mesh.nodes.emplace_back(x, y, z);
    }
  }
  mesh.corner_count = static_cast<std::int32_t>(mesh.nodes.size());
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.nodes.size()));
    if (fresh) mesh.nodes.emplace_back((mesh.nodes[a] + mesh.nodes[b]) / 2);
    return at->second;
  };
  std::map<std::array<int, 3>, std::pair<int, std::array<int, 3>>> faces;
  for (int k = 0; k + 1 < nz; ++k) {
    for (int j = 0; j + 1 < ny; ++j) {
      for (int i = 0; i + 1 < nx; ++i) {
        std::array<int, 3> axes{0, 1, 2};
        do {
          std::array<int, 3> at{i, j, k};
          std::array<int, 4> c{};
          c[0] = id(i, j, k);
          for (int s = 0; s < 3; ++s) {
            ++at[axes[s]];
            c[s + 1] = id(at[0], at[1], at[2]);
          }
          const auto& p = mesh.nodes;
          if ((p[c[1]] - p[c[0]]).cross(p[c[2]] - p[c[0]]).dot(p[c[3]] - p[c[0]]) < 0) std::swap(c[2], c[3]);
          mesh.tets.push_back({c[0], c[1], c[2], c[3], middle(c[0], c[1]), middle(c[1], c[2]), middle(c[2], c[0]),
                               middle(c[0], c[3]), middle(c[1], c[3]), middle(c[2], c[3])});
          for (const auto& f :
               {std::array<int, 3>{c[0], c[2], c[1]}, {c[0], c[1], c[3]}, {c[1], c[2], c[3]}, {c[2], c[0], c[3]}}) {
            auto key = f;
            std::sort(key.begin(), key.end());
            auto& entry = faces[key];
            ++entry.first;
            entry.second = f;
          }
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
    }
  }
  for (const auto& [key, entry] : faces) {
    const auto& f = entry.second;
    if (entry.first == 1) {
      mesh.faces.push_back({f[0], f[1], f[2], middle(f[0], f[1]), middle(f[1], f[2]), middle(f[2], f[0])});
    }
  }
  mesh.regions.assign(mesh.tets.size(), 0);
  return mesh;
}

}  // namespace palpate::test
