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
    if (!kTwoARegister || !at.inside()) return set(k, at.cubic(coefs), interval);
    const float* four = coefs + at.first();
    const auto& add = at.columns();
    Two low{}, high{};
    for (int j = 0; j < 4; ++j) {
      const double c = four[j];
      if (j < 3) low += two(c, c) * two(add[j][0], add[j][1]);  // the last function starts like a cube
      high += two(c, c) * two(add[j][2], add[j][3]);
    }
    const double power[4] = {low[0], low[1], high[0], high[1]};
    for (int p = 0; p < 4; ++p) power_[p].set(k, power[p]);
    start_.set(k, interval);
  }
  /// The same of the curves 2 i and 2 i + 1.
  void set_two(int i, const spline::CubicOf<Two>& cubic, int interval) const {
    for (int p = 0; p < 4; ++p) power_[p].of[i] = cubic.power[p];
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
    constexpr double kReach = 0.5 + kSlack;
    Lanes<N> off;
    unrolled<Lanes<N>::kTwos>([&](int i) PALPATE_INLINE_LAMBDA {
      share.of[i] = t.of[i] - start_.of[i];
      off.of[i] = share.of[i] - two(0.5, 0.5);
    });
    if constexpr (N % 2 != 0) off.set(N, 0);
    return squares_below(off.of, kReach * kReach);
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
  static constexpr double kNone = -1e9;  // further than any argument goes

  [[nodiscard]] PALPATE_TICK_INLINE Two cubic_at(int i, const Two& v) const {
    return (power_[0].of[i] + v * power_[1].of[i]) + v * v * (power_[2].of[i] + v * power_[3].of[i]);
  }

  mutable Lanes<N> start_;
  mutable Lanes<N> power_[4] = {};  ///< by powers of the share of the interval
};

}  // namespace palpate::runtime
