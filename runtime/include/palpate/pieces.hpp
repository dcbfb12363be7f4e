// SPDX-License-Identifier: MIT
// Splines that are asked again and again nearly where they were asked before: as a contact asks from tick to tick.
#pragma once

#include "palpate/lanes.hpp"
#include "palpate/spline.hpp"

#include <cmath>

namespace palpate::runtime {

/// N splines, each remembered as a cubic on the knot interval that was last asked for. The coefficients stay with the
/// caller. Not for several threads at once.
template <int N>
class Pieces {
public:
  /// Just outside its interval a cubic is that of the next up to the third power of this (in intervals): a deflection
  /// that trembles about a knot, as one of zero does, must not ask for another cubic every tick.
  static constexpr double kSlack = 1e-6;

  Pieces() { forget(); }

  /// Other coefficients from now on: of all curves, or of the curves 2 i and 2 i + 1.
  void forget() { start_.fill(kNone); }
  void forget(int i) { start_.of[i] = two(kNone, kNone); }

  /// Makes this curve k's cubic, that of an interval (spline::interval_onwards).
  void set(int k, const spline::Cubic& cubic, int interval) const {
    for (int p = 0; p < 4; ++p) power_[p].set(k, cubic.power[p]);
    start_.set(k, interval);
  }
  /// The same, of all its coefficients; two powers side by side, which compilers do not see.
  PALPATE_TICK_INLINE void take(int k, const float* coefs, const spline::Interval& at, int interval) const {
    if (!at.inside()) return set(k, at.cubic(coefs), interval);
    const float* four = coefs + at.first();
    const auto& add = at.columns();
    if constexpr (kTwoARegister) {
      Two low{}, high{};
      for (int j = 0; j < 4; ++j) {
        const double c = four[j];
        if (j < 3) low += two(c, c) * two(add[j][0], add[j][1]);  // the last function starts like a cube
        high += two(c, c) * two(add[j][2], add[j][3]);
      }
      const double power[4] = {low[0], low[1], high[0], high[1]};
      for (int p = 0; p < 4; ++p) power_[p].set(k, power[p]);
    } else {
      const double c[4] = {four[0], four[1], four[2], four[3]};
      by_powers(c, add, [&](int p, double sum) PALPATE_INLINE_LAMBDA { power_[p].set(k, sum); });
    }
    start_.set(k, interval);
  }
  /// The same of the curves 2 i and 2 i + 1, of which x and y are the four coefficients that take part.
  PALPATE_TICK_INLINE void take_two(int i, const float* x, const float* y, const spline::Interval& at,
                                    int interval) const {
    const Two four[4] = {two(x[0], y[0]), two(x[1], y[1]), two(x[2], y[2]), two(x[3], y[3])};
    if (kTwoARegister || !at.inside()) {
      const spline::CubicOf<Two> cubic = at.of_four(four);
      for (int p = 0; p < 4; ++p) power_[p].of[i] = cubic.power[p];
    } else {
      by_powers(four, at.columns(), [&](int p, const Two& sum) PALPATE_INLINE_LAMBDA { power_[p].of[i] = sum; });
    }
    start_.of[i] = two(interval, interval);
  }

  /// Curve k at t[k], for a caller that knows that these are in the curves' intervals.
  void known_values(const Lanes<N>& t, Lanes<N>& value) const {
    unrolled<Lanes<N>::kTwos>([&](int i) PALPATE_INLINE_LAMBDA { value.of[i] = cubic_at(i, t.of[i] - start_.of[i]); });
  }

  /// For one that does not, in two steps, of which the first does for all that have taken the same intervals: shares of
  /// the intervals, false where one of t is not in its curve's, or no number (its cubic is to be taken); the curves
  /// there.
  PALPATE_TICK_INLINE bool shares(const Lanes<N>& t, Lanes<N>& share) const {
    Lanes<N> off;
    unrolled<Lanes<N>::kTwos>([&](int i) PALPATE_INLINE_LAMBDA {
      share.of[i] = t.of[i] - start_.of[i];
      off.of[i] = share.of[i] - two(0.5, 0.5);
    });
    if constexpr (N % 2 != 0) off.set(N, 0);
    return squares_below(off.of, kReach * kReach);
  }
  /// The same of curve k alone.
  [[nodiscard]] PALPATE_TICK_INLINE bool on_interval(int k, double t) const {
    return std::fabs(t - start_[k] - 0.5) < kReach;
  }
  PALPATE_TICK_INLINE void at(const Lanes<N>& share, Lanes<N>& value) const {
    unrolled<Lanes<N>::kTwos>([&](int i) PALPATE_INLINE_LAMBDA { value.of[i] = cubic_at(i, share.of[i]); });
  }
  /// All at one share.
  void all_at(double share, Lanes<N>& value) const {
    unrolled<Lanes<N>::kTwos>([&](int i) PALPATE_INLINE_LAMBDA { value.of[i] = cubic_at(i, two(share, share)); });
  }

  /// Of curve k: the interval taken, and what it is there.
  [[nodiscard]] int interval(int k) const { return static_cast<int>(start_[k]); }
  [[nodiscard]] spline::Cubic cubic(int k) const { return {{power_[0][k], power_[1][k], power_[2][k], power_[3][k]}}; }

private:
  /// Of four coefficients, by what each adds: has every power kept before the next is made, for registers that hold one
  /// number each are few.
  template <class Number, class Keep>
  PALPATE_TICK_INLINE static void by_powers(const Number (&four)[4], const double (&add)[4][4], const Keep& keep) {
    unrolled<4>([&](int p) PALPATE_INLINE_LAMBDA {
      Number sum = add[0][p] * four[0] + add[1][p] * four[1] + add[2][p] * four[2];
      if (p == 3) sum = sum + add[3][3] * four[3];  // the last function starts like a cube
      keep(p, sum);
    });
  }

  static constexpr double kReach = 0.5 + kSlack;  // of an interval's middle
  static constexpr double kNone = -1e9;           // further than any argument goes

  [[nodiscard]] PALPATE_TICK_INLINE Two cubic_at(int i, const Two& v) const {
    return (power_[0].of[i] + v * power_[1].of[i]) + v * v * (power_[2].of[i] + v * power_[3].of[i]);
  }

  mutable Lanes<N> start_;
  mutable Lanes<N> power_[4] = {};  ///< by powers of the share of the interval
};

}  // namespace palpate::runtime
