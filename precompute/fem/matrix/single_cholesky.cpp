// SPDX-License-Identifier: GPL-3.0-or-later
// Left-looking supernodal factorisation (Ng and Peyton 1993; Chen, Davis, Hager and Rajamanickam 2008, section 3) with
// the dense kernels of BLAS.
#include "precompute/fem/matrix/single_cholesky.hpp"

#include <cblas.h>
#include <algorithm>

// Of LAPACK (Fortran: the last argument is the length of the first), which OpenBLAS brings in its own registers.
extern "C" void spotrf_(const char* triangle, const int* size, float* matrix, const int* stride, int* info,
                        std::size_t length);

namespace palpate::fem {

using Eigen::VectorXd;
using Eigen::VectorXf;

SingleCholesky::SingleCholesky(const Matrix& lower, SupernodalPattern pattern) : pattern_(std::move(pattern)) {
  const SupernodalPattern& p = pattern_;
  const int count = static_cast<int>(p.first.size()) - 1;
  values_.resize(static_cast<std::size_t>(p.values.back()));
  owner_.resize(p.order.size());
  for (int s = 0; s < count; ++s) {
    const int columns = p.first[s + 1] - p.first[s], height = p.begin[s + 1] - p.begin[s];
    std::fill_n(owner_.begin() + p.first[s], columns, s);
    supernodes_.push_back(
        {p.first[s], columns, height, p.rows.data() + p.begin[s] + columns, values_.data() + p.values[s]});
    tallest_ = std::max(tallest_, height);
  }
  std::vector<int> position(p.order.size());
  for (std::size_t k = 0; k < p.order.size(); ++k) position[p.order[k]] = static_cast<int>(k);
  for (int j = 0; j < lower.outerSize(); ++j) {
    for (Matrix::InnerIterator it(lower, j); it; ++it) {
      const auto [column, row] = std::minmax(position[it.row()], position[it.col()]);
      const int s = owner_[column];
      const auto rows = p.rows.begin() + p.begin[s];
      const auto at = std::lower_bound(rows, p.rows.begin() + p.begin[s + 1], row);
      places_.push_back(p.values[s] + (column - p.first[s]) * supernodes_[s].height + static_cast<int>(at - rows));
    }
  }
  head_.resize(supernodes_.size());
  next_.resize(supernodes_.size());
  reached_.resize(supernodes_.size());
  place_of_row_.resize(p.order.size());
  places_of_update_.resize(static_cast<std::size_t>(tallest_));
}

// Subtracts what the columns of a finished supernode give to this one, and hands it on to the next that it updates.
void SingleCholesky::update(int descendant, int supernode) {
  const Supernode &from = supernodes_[descendant], &to = supernodes_[supernode];
  const int* const rows = pattern_.rows.data() + pattern_.begin[descendant];
  const int first = reached_[descendant], end = to.first + to.columns;
  const int last = static_cast<int>(std::lower_bound(rows + first, rows + from.height, end) - rows);
  const int tall = from.height - first, wide = last - first;
  if (product_.size() < std::size_t(tall) * std::size_t(wide)) product_.resize(std::size_t(tall) * std::size_t(wide));
  cblas_sgemm(CblasColMajor, CblasNoTrans, CblasTrans, tall, wide, from.columns, 1.0F, from.values + first, from.height,
              from.values + first, from.height, 0.0F, product_.data(), tall);
  float* const values = values_.data() + pattern_.values[supernode];
  for (int i = 0; i < tall; ++i) places_of_update_[i] = place_of_row_[rows[first + i]];
  const int* const places = places_of_update_.data();
  const bool together = places[tall - 1] - places[0] == tall - 1;
  for (int j = 0; j < wide; ++j) {
    float* const column = values + std::ptrdiff_t(rows[first + j] - to.first) * to.height;
    const float* const given = product_.data() + std::ptrdiff_t(j) * tall;
    if (together) {
      for (int i = j; i < tall; ++i) column[places[0] + i] -= given[i];
    } else {
      for (int i = j; i < tall; ++i) column[places[i]] -= given[i];
    }
  }
  reached_[descendant] = last;
  if (last == from.height) return;
  const int heir = owner_[rows[last]];
  next_[descendant] = head_[heir];
  head_[heir] = descendant;
}

bool SingleCholesky::eliminate(int supernode) {
  const Supernode& n = supernodes_[supernode];
  const int* const rows = pattern_.rows.data() + pattern_.begin[supernode];
  for (int k = 0; k < n.height; ++k) place_of_row_[rows[k]] = k;
  for (int d = head_[supernode]; d >= 0;) {
    const int next = next_[d];
    update(d, supernode);
    d = next;
  }
  float* const values = values_.data() + pattern_.values[supernode];
  int info = 0;
  spotrf_("L", &n.columns, values, &n.height, &info, 1);
  if (info != 0) return false;
  const int below = n.height - n.columns;
  reached_[supernode] = n.columns;
  if (below == 0) return true;
  cblas_strsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, below, n.columns, 1.0F, values, n.height,
              values + n.columns, n.height);
  const int heir = owner_[n.rows[0]];
  next_[supernode] = head_[heir];
  head_[heir] = supernode;
  return true;
}

bool SingleCholesky::factorise(const Matrix& lower) {
  std::fill(values_.begin(), values_.end(), 0.0F);
  for (std::size_t k = 0; k < places_.size(); ++k) values_[places_[k]] = static_cast<float>(lower.valuePtr()[k]);
  std::fill(head_.begin(), head_.end(), -1);
  for (int s = 0; s < static_cast<int>(supernodes_.size()); ++s) {
    if (!eliminate(s)) return false;
  }
  return true;
}

VectorXd SingleCholesky::solve(const VectorXd& b) const {
  const Eigen::Map<const Eigen::VectorXi> order(pattern_.order.data(), b.size());
  // Forces of millinewtons on stiffnesses of any size: scaled, they stay far from the ends of a float's range.
  const double scale = b.cwiseAbs().maxCoeff();
  if (!(scale > 0)) return VectorXd::Zero(b.size());
  VectorXf y = (b(order) / scale).cast<float>(), work(tallest_);
  solve_lower(supernodes_, y.data(), work.data());
  solve_upper(supernodes_, y.data(), work.data());
  VectorXd x(b.size());
  x(order) = scale * y.cast<double>();
  return x;
}

}  // namespace palpate::fem
