// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks as the element tests deform them: distorted meshes, maps of every node, states that degenerate.
#pragma once

#include "precompute/fem/element_batch.hpp"
#include "tests/support/block_mesh.hpp"
#include "tests/support/finite_difference.hpp"

#include <array>
#include <random>
#include <vector>

namespace palpate::test {

/// Whole, stretched, flat, inside out, needles without and with a little area, a sheet, a point; to be shaken.
inline const std::array<Eigen::Vector3d, 8> kDegenerate{
    Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1.4, 0.8, 0.9), Eigen::Vector3d(1, 1, 0),    Eigen::Vector3d(1, 0.9, -1),
    Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 0.01, 0.01), Eigen::Vector3d(0.01, 3, 1), Eigen::Vector3d(0, 0, 0)};

/// Node positions (3 N, m) under x -> f x.
inline Eigen::VectorXd mapped(const mesh::TetMesh& mesh, const Eigen::Matrix3d& f) {
  Eigen::VectorXd x = stacked(mesh);
  for (Eigen::Index k = 0; k < x.size(); k += 3) x.segment<3>(k) = (f * x.segment<3>(k)).eval();
  return x;
}

/// Every coordinate moved at random by up to `by` (m).
inline Eigen::VectorXd shaken(Eigen::VectorXd x, double by, std::mt19937& engine) {
  std::uniform_real_distribution<double> noise(-by, by);
  for (auto& v : x) v += noise(engine);
  return x;
}

/// Corners moved at random by up to `by` (m), those on faces of the block within them; middles on the straight edges.
inline mesh::TetMesh distorted_block(const std::vector<double>& xs, const std::vector<double>& ys,
                                     const std::vector<double>& zs, double by) {
  mesh::TetMesh mesh = block_mesh(xs, ys, zs);
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> noise(-by, by);
  const Eigen::Vector3d low(xs.front(), ys.front(), zs.front()), high(xs.back(), ys.back(), zs.back());
  for (std::int32_t n = 0; n < mesh.corner_count; ++n) {
    Eigen::Vector3d& at = mesh.nodes[n];
    for (int k = 0; k < 3; ++k) {
      if (at[k] > low[k] && at[k] < high[k]) at[k] += noise(engine);
    }
  }
  for (const auto& t : mesh.tets) {
    for (int k = 0; k < 6; ++k) {
      const auto [i, j] = fem::kElementEdges[k];
      mesh.nodes[t[4 + k]] = (mesh.nodes[t[i]] + mesh.nodes[t[j]]) / 2;
    }
  }
  return mesh;
}

}  // namespace palpate::test
