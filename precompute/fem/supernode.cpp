// SPDX-License-Identifier: GPL-3.0-or-later
// A solve reads every value of the factor once for two operations: what counts is to load them in wide registers, four
// columns at a time, so that the vector beside them is loaded a quarter as often.
#include "precompute/fem/supernode.hpp"

#include "precompute/fem/registers.hpp"

#include <algorithm>
#include <cstring>

namespace palpate {
namespace {

constexpr int kColumns = 4;  // of a block
constexpr int kLanes = 16;
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));

[[gnu::always_inline]] inline void load(const float* from, Lanes& lanes) { std::memcpy(&lanes, from, sizeof lanes); }

// w[k] -= sum_j a_j[k] t_j for `count` rows; `a` points to the first column's.
template <int Columns>
[[gnu::always_inline]] inline void subtract(const float* a, int height, const float (&t)[kColumns], float* w,
                                            int count) {
  int k = 0;
  for (; k + kLanes <= count; k += kLanes) {
    Lanes sum, column;
    load(w + k, sum);
    for (int j = 0; j < Columns; ++j) {
      load(a + std::ptrdiff_t(j) * height + k, column);
      sum -= column * t[j];
    }
    std::memcpy(w + k, &sum, sizeof sum);
  }
  for (; k < count; ++k) {
    for (int j = 0; j < Columns; ++j) w[k] -= a[std::ptrdiff_t(j) * height + k] * t[j];
  }
}

// t_j -= a_j . w over `count` rows.
template <int Columns>
[[gnu::always_inline]] inline void reduce(const float* a, int height, const float* w, int count, float (&t)[kColumns]) {
  Lanes sums[Columns] = {};
  int k = 0;
  for (; k + kLanes <= count; k += kLanes) {
    Lanes along, column;
    load(w + k, along);
    for (int j = 0; j < Columns; ++j) {
      load(a + std::ptrdiff_t(j) * height + k, column);
      sums[j] += column * along;
    }
  }
  for (int j = 0; j < Columns; ++j) {
    for (int lane = 0; lane < kLanes; ++lane) t[j] -= sums[j][lane];
  }
  for (; k < count; ++k) {
    for (int j = 0; j < Columns; ++j) t[j] -= a[std::ptrdiff_t(j) * height + k] * w[k];
  }
}

// The block of `Columns` columns whose first is `at`; w holds triangle and panel rows.
template <int Columns>
[[gnu::always_inline]] inline void block_lower(const Supernode& n, int at, float* w) {
  const float* const a = n.values + std::ptrdiff_t(at) * n.height + at;
  float t[kColumns];
  for (int j = 0; j < Columns; ++j) {
    t[j] = w[at + j];
    for (int i = 0; i < j; ++i) t[j] -= a[std::ptrdiff_t(i) * n.height + j] * t[i];
    t[j] /= a[std::ptrdiff_t(j) * n.height + j];
    w[at + j] = t[j];
  }
  subtract<Columns>(a + Columns, n.height, t, w + at + Columns, n.height - at - Columns);
}

template <int Columns>
[[gnu::always_inline]] inline void block_upper(const Supernode& n, int at, float* w) {
  const float* const a = n.values + std::ptrdiff_t(at) * n.height + at;
  float t[kColumns];
  for (int j = 0; j < Columns; ++j) t[j] = w[at + j];
  reduce<Columns>(a + Columns, n.height, w + at + Columns, n.height - at - Columns, t);
  for (int j = Columns; j-- > 0;) {
    for (int i = j + 1; i < Columns; ++i) t[j] -= a[std::ptrdiff_t(j) * n.height + i] * t[i];
    t[j] /= a[std::ptrdiff_t(j) * n.height + j];
    w[at + j] = t[j];
  }
}

[[gnu::always_inline]] inline void lower(const std::vector<Supernode>& factor, float* y, float* w) {
  for (const Supernode& n : factor) {
    std::copy_n(y + n.first, n.columns, w);
    std::fill_n(w + n.columns, n.height - n.columns, 0.0F);
    int at = 0;
    for (; at + kColumns <= n.columns; at += kColumns) block_lower<kColumns>(n, at, w);
    for (; at < n.columns; ++at) block_lower<1>(n, at, w);
    std::copy_n(w, n.columns, y + n.first);
    for (int k = n.columns; k < n.height; ++k) y[n.rows[k - n.columns]] += w[k];
  }
}

[[gnu::always_inline]] inline void upper(const std::vector<Supernode>& factor, float* y, float* w) {
  for (std::size_t s = factor.size(); s-- > 0;) {
    const Supernode& n = factor[s];
    std::copy_n(y + n.first, n.columns, w);
    for (int k = n.columns; k < n.height; ++k) w[k] = y[n.rows[k - n.columns]];
    int at = n.columns - n.columns % kColumns;
    for (int last = n.columns; last-- > at;) block_upper<1>(n, last, w);
    while ((at -= kColumns) >= 0) block_upper<kColumns>(n, at, w);
    std::copy_n(w, n.columns, y + n.first);
  }
}

using Solve = void (*)(const std::vector<Supernode>&, float*, float*);

void lower_plain(const std::vector<Supernode>& f, float* y, float* w) { lower(f, y, w); }
void upper_plain(const std::vector<Supernode>& f, float* y, float* w) { upper(f, y, w); }
PALPATE_AVX2 void lower_avx2(const std::vector<Supernode>& f, float* y, float* w) { lower(f, y, w); }
PALPATE_AVX2 void upper_avx2(const std::vector<Supernode>& f, float* y, float* w) { upper(f, y, w); }
PALPATE_AVX512 void lower_avx512(const std::vector<Supernode>& f, float* y, float* w) { lower(f, y, w); }
PALPATE_AVX512 void upper_avx512(const std::vector<Supernode>& f, float* y, float* w) { upper(f, y, w); }

const Solve best_lower = widest<Solve>(lower_plain, lower_avx2, lower_avx512);
const Solve best_upper = widest<Solve>(upper_plain, upper_avx2, upper_avx512);

}  // namespace

void solve_lower(const std::vector<Supernode>& factor, float* y, float* work) { best_lower(factor, y, work); }
void solve_upper(const std::vector<Supernode>& factor, float* y, float* work) { best_upper(factor, y, work); }

}  // namespace palpate
