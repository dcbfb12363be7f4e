// SPDX-License-Identifier: MIT
// Numbers that are computed side by side, two in a register where there are such.
#pragma once

namespace palpate::runtime {

/// GCC's and clang's vectors; without such registers compilers take them number by number. Loops over plain numbers
/// are left to chance: what a compiler puts side by side changes with what stands round it.
using Two = double __attribute__((vector_size(16)));

inline Two two(double x, double y) { return Two{x, y}; }
inline Two swapped(const Two& a) { return Two{a[1], a[0]}; }
/// a where it is above 0, else 0, as where it is no number.
inline Two positive(const Two& a) {
  const auto above = a > Two{};
  using Bits = decltype(+above);
  return reinterpret_cast<Two>(above & reinterpret_cast<Bits>(a));
}
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
  /// The squares of all are below `limit`; no number is not.
  [[nodiscard]] bool squares_below(double limit) const {
    const Two most = two(limit, limit);
    auto below = of[0] * of[0] < most;
    for (int i = 1; i < kTwos; ++i) below &= of[i] * of[i] < most;
    return (below[0] & below[1]) != 0;
  }
};

}  // namespace palpate::runtime
