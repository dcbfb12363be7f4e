// SPDX-License-Identifier: MIT
// Numbers that are computed side by side, two in a register where there are such.
#pragma once

#include "palpate/math3.hpp"

namespace palpate::runtime {

#if defined(__SSE2__) || (defined(__GNUC__) && defined(__aarch64__))
/// GCC's and clang's vectors. Loops over plain numbers are left to chance: what a compiler puts side by side changes
/// with what stands round it.
using Two = double __attribute__((vector_size(16)));
inline constexpr bool kTwoARegister = true;

/// a where it is above 0, else 0, as where it is no number.
inline Two positive(const Two& a) {
  const auto above = a > Two{};
  return reinterpret_cast<Two>(above & reinterpret_cast<decltype(+above)>(a));
}
inline Two larger(const Two& a, const Two& b) { return a > b ? a : b; }
inline Two smaller(const Two& a, const Two& b) { return a < b ? a : b; }
/// The squares of all are below `limit`; no number is not.
template <int n>
PALPATE_TICK_INLINE bool squares_below(const Two (&a)[n], double limit) {
  const Two most{limit, limit};
  auto below = a[0] * a[0] < most;
  for (int i = 1; i < n; ++i) below &= a[i] * a[i] < most;
  return (below[0] & below[1]) != 0;
}
#else
/// Where registers hold one number each.
inline constexpr bool kTwoARegister = false;
struct Two {
  double at[2];
  double& operator[](int k) { return at[k]; }
  double operator[](int k) const { return at[k]; }
};
inline Two operator+(const Two& a, const Two& b) { return {{a.at[0] + b.at[0], a.at[1] + b.at[1]}}; }
inline Two operator-(const Two& a, const Two& b) { return {{a.at[0] - b.at[0], a.at[1] - b.at[1]}}; }
inline Two operator*(const Two& a, const Two& b) { return {{a.at[0] * b.at[0], a.at[1] * b.at[1]}}; }
inline Two operator*(double a, const Two& b) { return {{a * b.at[0], a * b.at[1]}}; }
inline Two operator/(const Two& a, const Two& b) { return {{a.at[0] / b.at[0], a.at[1] / b.at[1]}}; }
inline Two& operator+=(Two& a, const Two& b) { return a = a + b; }
inline Two& operator*=(Two& a, const Two& b) { return a = a * b; }

inline Two positive(const Two& a) { return {{a.at[0] > 0 ? a.at[0] : 0, a.at[1] > 0 ? a.at[1] : 0}}; }
inline Two larger(const Two& a, const Two& b) {
  return {{a.at[0] > b.at[0] ? a.at[0] : b.at[0], a.at[1] > b.at[1] ? a.at[1] : b.at[1]}};
}
inline Two smaller(const Two& a, const Two& b) {
  return {{a.at[0] < b.at[0] ? a.at[0] : b.at[0], a.at[1] < b.at[1] ? a.at[1] : b.at[1]}};
}
/// The same, of what are all numbers or none.
template <int n>
PALPATE_TICK_INLINE bool squares_below(const Two (&a)[n], double limit) {
  double most = 0;  // one branch, which takes a microcontroller as long as three operations
  for (const Two& each : a) most = std::fmax(std::fmax(most, each.at[0] * each.at[0]), each.at[1] * each.at[1]);
  return most < limit;
}
#endif

inline bool any_above_zero(const Two& a) { return a[0] > 0 || a[1] > 0; }
inline bool all_above_zero(const Two& a) { return a[0] > 0 && a[1] > 0; }
inline Two square_root(const Two& a) { return Two{std::sqrt(a[0]), std::sqrt(a[1])}; }

/// The same of one number.
inline double positive(double a) { return a > 0 ? a : 0; }
inline bool any_above_zero(double a) { return a > 0; }
inline bool all_above_zero(double a) { return a > 0; }
inline double square_root(double a) { return std::sqrt(a); }

inline Two two(double x, double y) { return Two{x, y}; }
inline Two swapped(const Two& a) { return Two{a[1], a[0]}; }

/// N numbers; of an odd N there is one more.
template <int N>
struct Lanes {
  static constexpr int kTwos = (N + 1) / 2;
  Two of[kTwos];

  [[nodiscard]] double operator[](int k) const { return of[k / 2][k % 2]; }
  void set(int k, double value) { of[k / 2][k % 2] = value; }
  void fill(double value) {
    for (Two& each : of) each = two(value, value);
  }
};

/// use(0), use(1), ... use(N - 1): inlined, each knows its number, which of a loop is up to the compiler.
template <int N, class Use>
PALPATE_TICK_INLINE void unrolled(const Use& use) {
  if constexpr (N > 1) unrolled<N - 1>(use);
  use(N - 1);
}

}  // namespace palpate::runtime
