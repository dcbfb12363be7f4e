// SPDX-License-Identifier: GPL-3.0-or-later
// Symmetric sparse matrix of 3x3 node blocks over the free nodes of a mesh, stored as the lower triangle in
// compressed columns, ready for CHOLMOD.
#pragma once

#include "precompute/mesh/tet_mesh.hpp"

#include <Eigen/Sparse>
#include <vector>

namespace palpate::fem {

class BlockMatrix {
public:
  /// Pattern: nodes that share a tetrahedron. `fixed[node]` nodes have no rows.
  BlockMatrix(const mesh::TetMesh& mesh, const std::vector<char>& fixed);

  void set_zero() { matrix_.coeffs().setZero(); }
  /// Adds `block` (rows: node a, columns: node b) and, where a != b, its transpose at (b, a); call once per
  /// unordered pair. Entries of fixed nodes are dropped. a and b must share a tetrahedron.
  void add(std::int32_t a, std::int32_t b, const Eigen::Matrix3d& block);

  [[nodiscard]] const Eigen::SparseMatrix<double>& matrix() const { return matrix_; }
  [[nodiscard]] std::int32_t free_nodes() const { return static_cast<std::int32_t>(rows_.size()); }

private:
  std::vector<std::int32_t> index_;
  std::vector<std::vector<std::int32_t>> rows_;  // per free node the free nodes >= it that it couples with, sorted
  Eigen::SparseMatrix<double> matrix_;
};

}  // namespace palpate::fem
