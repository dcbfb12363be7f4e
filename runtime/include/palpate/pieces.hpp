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

  /// Other coefficients from now on: of all curves, or of curve k.
  void forget() { start_.fill(kNone); }
  void forget(int k) { start_.set(k, kNone); }

  /// Makes curve k's cubic that of an interval (spline::interval_onwards).
  template <class Scalar>
  void take(int k, const Scalar* coefs, int count, int interval) const {
    if (start_[k] != interval) set(k, spline::cubic(coefs, count, interval), interval);
  }
  /// The same for a caller that knows that curve k has another, and its cubic.
  void set(int k, const spline::Cubic& cubic, int interval) const {
    for (int p = 0; p < 4; ++p) power_[p].set(k, cubic.power[p]);
    start_.set(k, interval);
  }

  /// Curve k at t[k], for a caller that knows that these are in the curves' intervals.
  void known_values(const Lanes<N>& t, Lanes<N>& value) const {
    for (int i = 0; i < Lanes<N>::kTwos; ++i) value.of[i] = cubic_at(i, t.of[i] - start_.of[i]);
  }

  /// For one that does not, in two steps, of which the first does for all that have taken the same intervals: shares of
  /// the intervals, false where one of t is not in its curve's, or no number (its cubic is to be taken); the curves
  /// there.
  PALPATE_TICK_INLINE bool shares(const Lanes<N>& t, Lanes<N>& share) const {
    constexpr double kReach = 0.5 + kSlack;
    Lanes<N> off;
    for (int i = 0; i < Lanes<N>::kTwos; ++i) {
      share.of[i] = t.of[i] - start_.of[i];
      off.of[i] = share.of[i] - two(0.5, 0.5);
    }
    if constexpr (N % 2 != 0) off.set(N, 0);
    return squares_below(off.of, kReach * kReach);
  }
  PALPATE_TICK_INLINE void at(const Lanes<N>& share, Lanes<N>& value) const {
    for (int i = 0; i < Lanes<N>::kTwos; ++i) value.of[i] = cubic_at(i, share.of[i]);
  }
  /// All at one share.
  void all_at(double share, Lanes<N>& value) const {
    for (int i = 0; i < Lanes<N>::kTwos; ++i) value.of[i] = cubic_at(i, two(share, share));
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
