// SPDX-License-Identifier: GPL-3.0-or-later
// A solve reads every value of the factor once for two operations: what counts is to load them in wide registers, four
// columns at a time, so that the vector beside them is loaded a quarter as often.
#include "precompute/fem/matrix/supernode.hpp"

#include "precompute/fem/matrix/registers.hpp"

#include <algorithm>
#include <cstring>

namespace palpate::fem {
namespace {

constexpr int kColumns = 4;  // of a block
constexpr int kRows = 16;    // at once; of those left over 8, then 4, then one by one, for registers of any width

template <int Width>
struct Lanes {
  typedef float Type __attribute__((vector_size(Width * sizeof(float))));
};
using Four = Lanes<4>::Type;
using Eight = Lanes<8>::Type;

template <class Register>
[[gnu::always_inline]] inline void load(const float* from, Register& lanes) {
  std::memcpy(&lanes, from, sizeof lanes);
}

// w[k] -= sum_j a_j[k] t_j for the rows of one register.
template <class Register, int Columns>
[[gnu::always_inline]] inline void subtract_rows(const float* a, int height, const float (&t)[kColumns], float* w) {
  Register sum, column;
  load(w, sum);
  for (int j = 0; j < Columns; ++j) {
    load(a + std::ptrdiff_t(j) * height, column);
    sum -= column * t[j];
  }
  std::memcpy(w, &sum, sizeof sum);
}

// w[k] -= sum_j a_j[k] t_j for `count` rows; `a` points to the first column's.
template <int Width, int Columns>
[[gnu::always_inline]] inline void subtract(const float* a, int height, const float (&t)[kColumns], float* w,
                                            int count) {
  int k = 0;
  for (; k + Width <= count; k += Width) {
    subtract_rows<typename Lanes<Width>::Type, Columns>(a + k, height, t, w + k);
  }
  for (; k + 4 <= count; k += 4) subtract_rows<Four, Columns>(a + k, height, t, w + k);
  for (; k < count; ++k) {
    for (int j = 0; j < Columns; ++j) w[k] -= a[std::ptrdiff_t(j) * height + k] * t[j];
  }
}

// sums[j] += a_j[k] w[k] for the rows of one register.
template <class Register, int Columns>
[[gnu::always_inline]] inline void add_products(const float* a, int height, const float* w, Register* sums) {
  Register along, column;
  load(w, along);
  for (int j = 0; j < Columns; ++j) {
    load(a + std::ptrdiff_t(j) * height, column);
    sums[j] += column * along;
  }
}

// The sums of rows 0 to 3 and 4 to 7 of eight; of sixteen, which may be spread over registers, first their halves'.
[[gnu::always_inline]] inline void fold(const Eight& v, Four& sum) {
  sum = __builtin_shufflevector(v, v, 0, 1, 2, 3) + __builtin_shufflevector(v, v, 4, 5, 6, 7);
}

template <int Width>
[[gnu::always_inline]] inline void fold(const typename Lanes<Width>::Type* parts, std::ptrdiff_t stride, Eight& sum) {
  if constexpr (Width == 16) {
    sum = __builtin_shufflevector(parts[0], parts[0], 0, 1, 2, 3, 4, 5, 6, 7) +
          __builtin_shufflevector(parts[0], parts[0], 8, 9, 10, 11, 12, 13, 14, 15);
  } else if constexpr (Width == 8) {
    sum = parts[0] + parts[stride];
  } else {
    const Four low = parts[0] + parts[2 * stride], high = parts[stride] + parts[3 * stride];
    sum = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
  }
}

// t_j -= a_j . w over `count` rows. Every width adds in the same order, so that a solve gives the same bits.
template <int Width, int Columns>
[[gnu::always_inline]] inline void reduce(const float* a, int height, const float* w, int count, float (&t)[kColumns]) {
  using Register = typename Lanes<Width>::Type;
  Register sums[kRows / Width][Columns] = {};
  int k = 0;
  for (; k + kRows <= count; k += kRows) {
    for (int part = 0; part < kRows / Width; ++part) {
      add_products<Register, Columns>(a + k + part * Width, height, w + k + part * Width, sums[part]);
    }
  }
  Eight eights[Columns];
  for (int j = 0; j < Columns; ++j) fold<Width>(&sums[0][j], Columns, eights[j]);
  if (k + 8 <= count) {
    add_products<Eight, Columns>(a + k, height, w + k, eights);
    k += 8;
  }
  Four fours[Columns];
  for (int j = 0; j < Columns; ++j) fold(eights[j], fours[j]);
  if (k + 4 <= count) {
    add_products<Four, Columns>(a + k, height, w + k, fours);
    k += 4;
  }
  for (int j = 0; j < Columns; ++j) t[j] -= (fours[j][0] + fours[j][2]) + (fours[j][1] + fours[j][3]);
  for (; k < count; ++k) {
    for (int j = 0; j < Columns; ++j) t[j] -= a[std::ptrdiff_t(j) * height + k] * w[k];
  }
}

// The block of `Columns` columns whose first is `at`; w holds triangle and panel rows.
template <int Width, int Columns>
[[gnu::always_inline]] inline void block_lower(const Supernode& n, int at, float* w) {
  const float* const a = n.values + std::ptrdiff_t(at) * n.height + at;
  float t[kColumns];
  for (int j = 0; j < Columns; ++j) {
    t[j] = w[at + j];
    for (int i = 0; i < j; ++i) t[j] -= a[std::ptrdiff_t(i) * n.height + j] * t[i];
    t[j] /= a[std::ptrdiff_t(j) * n.height + j];
    w[at + j] = t[j];
  }
  subtract<Width, Columns>(a + Columns, n.height, t, w + at + Columns, n.height - at - Columns);
}

template <int Width, int Columns>
[[gnu::always_inline]] inline void block_upper(const Supernode& n, int at, float* w) {
  const float* const a = n.values + std::ptrdiff_t(at) * n.height + at;
  float t[kColumns];
  for (int j = 0; j < Columns; ++j) t[j] = w[at + j];
  reduce<Width, Columns>(a + Columns, n.height, w + at + Columns, n.height - at - Columns, t);
  for (int j = Columns; j-- > 0;) {
    for (int i = j + 1; i < Columns; ++i) t[j] -= a[std::ptrdiff_t(j) * n.height + i] * t[i];
    t[j] /= a[std::ptrdiff_t(j) * n.height + j];
    w[at + j] = t[j];
  }
}

template <int Width>
[[gnu::always_inline]] inline void lower(const std::vector<Supernode>& factor, float* y, float* w) {
  for (const Supernode& n : factor) {
    std::copy_n(y + n.first, n.columns, w);
    std::fill_n(w + n.columns, n.height - n.columns, 0.0F);
    int at = 0;
    for (; at + kColumns <= n.columns; at += kColumns) block_lower<Width, kColumns>(n, at, w);
    for (; at < n.columns; ++at) block_lower<Width, 1>(n, at, w);
    std::copy_n(w, n.columns, y + n.first);
    for (int k = n.columns; k < n.height; ++k) y[n.rows[k - n.columns]] += w[k];
  }
}

template <int Width>
[[gnu::always_inline]] inline void upper(const std::vector<Supernode>& factor, float* y, float* w) {
  for (std::size_t s = factor.size(); s-- > 0;) {
    const Supernode& n = factor[s];
    std::copy_n(y + n.first, n.columns, w);
    for (int k = n.columns; k < n.height; ++k) w[k] = y[n.rows[k - n.columns]];
    int at = n.columns - n.columns % kColumns;
    for (int last = n.columns; last-- > at;) block_upper<Width, 1>(n, last, w);
    while ((at -= kColumns) >= 0) block_upper<Width, kColumns>(n, at, w);
    std::copy_n(w, n.columns, y + n.first);
  }
}

using Solve = void (*)(const std::vector<Supernode>&, float*, float*);

void lower_plain(const std::vector<Supernode>& f, float* y, float* w) { lower<4>(f, y, w); }
void upper_plain(const std::vector<Supernode>& f, float* y, float* w) { upper<4>(f, y, w); }
PALPATE_AVX2 void lower_avx2(const std::vector<Supernode>& f, float* y, float* w) { lower<8>(f, y, w); }
PALPATE_AVX2 void upper_avx2(const std::vector<Supernode>& f, float* y, float* w) { upper<8>(f, y, w); }
PALPATE_AVX512 void lower_avx512(const std::vector<Supernode>& f, float* y, float* w) { lower<16>(f, y, w); }
PALPATE_AVX512 void upper_avx512(const std::vector<Supernode>& f, float* y, float* w) { upper<16>(f, y, w); }

const Solve best_lower = widest<Solve>(lower_plain, lower_avx2, lower_avx512);
const Solve best_upper = widest<Solve>(upper_plain, upper_avx2, upper_avx512);

}  // namespace

void solve_lower(const std::vector<Supernode>& factor, float* y, float* work) { best_lower(factor, y, work); }
void solve_upper(const std::vector<Supernode>& factor, float* y, float* work) { best_upper(factor, y, work); }

}  // namespace palpate::fem
