// SPDX-License-Identifier: GPL-3.0-or-later
// Pattern and assembly of the block matrix.
#include "precompute/fem/matrix/block_matrix.hpp"

#include <algorithm>

namespace palpate::fem {

BlockMatrix::BlockMatrix(const mesh::TetMesh& mesh, const std::vector<char>& fixed) : index_(mesh.nodes.size(), -1) {
  std::int32_t count = 0;
  for (std::size_t n = 0; n < index_.size(); ++n) {
    if (!fixed[n]) index_[n] = count++;
  }
  rows_.resize(count);
  for (const auto& tet : mesh.tets) {
    for (const std::int32_t a : tet) {
      for (const std::int32_t b : tet) {
        if (index_[b] >= 0 && index_[a] >= index_[b]) rows_[index_[b]].push_back(index_[a]);
      }
    }
  }
  for (auto& rows : rows_) {
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    if (rows.empty()) rows.push_back(static_cast<std::int32_t>(&rows - rows_.data()));  // a node of no tetrahedron
  }
  // Compressed columns written directly: entry-wise insertion would move the whole matrix again and again.
  std::vector<int> starts(3 * static_cast<std::size_t>(count) + 1, 0), inner;
  for (std::int32_t b = 0; b < count; ++b) {
    for (int j = 0; j < 3; ++j) {
      for (const std::int32_t a : rows_[b]) {
        for (int i = a == b ? j : 0; i < 3; ++i) inner.push_back(3 * a + i);
      }
      starts[3 * b + j + 1] = static_cast<int>(inner.size());
    }
  }
  const std::vector<double> zeros(inner.size(), 0.0);
  matrix_ = Eigen::Map<const Eigen::SparseMatrix<double>>(3 * count, 3 * count, static_cast<Eigen::Index>(inner.size()),
                                                          starts.data(), inner.data(), zeros.data());
}

namespace {

// Index of `row` in ascending `rows`, which contain it. Branch-free, because half of the branches would be
// mispredicted.
std::ptrdiff_t rank_of(const std::vector<std::int32_t>& rows, std::int32_t row) {
  const std::int32_t* at = rows.data();
  for (std::size_t count = rows.size(); count > 1;) {
    const std::size_t half = count / 2;
    at = at[half] <= row ? at + half : at;
    count -= half;
  }
  return at - rows.data();
}

}  // namespace

void BlockMatrix::add(std::int32_t a, std::int32_t b, const Eigen::Matrix3d& block) {
  std::int32_t row = index_[a], col = index_[b];
  if (row < 0 || col < 0) return;
  const bool transposed = row < col;
  if (transposed) std::swap(row, col);
  const std::ptrdiff_t rank = rank_of(rows_[col], row);
  double* const values = matrix_.valuePtr();
  const int* const starts = matrix_.outerIndexPtr() + 3 * std::ptrdiff_t(col);
  if (rank == 0) {
    for (int j = 0; j < 3; ++j) {
      for (int i = j; i < 3; ++i) values[starts[j] + i - j] += block(i, j);
    }
    return;
  }
  for (int j = 0; j < 3; ++j) {
    double* const place = values + starts[j] + (3 - j) + 3 * (rank - 1);
    for (int i = 0; i < 3; ++i) place[i] += transposed ? block(j, i) : block(i, j);
  }
}

}  // namespace palpate::fem
