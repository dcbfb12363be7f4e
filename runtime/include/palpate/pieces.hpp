// SPDX-License-Identifier: MIT
// Splines that are asked again and again nearly where they were asked before: as a contact asks from tick to tick.
#pragma once

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
  void forget() {
    for (double& start : start_) start = kNone;
  }
  void forget(int k) { start_[k] = kNone; }

  /// Makes curve k's cubic that of the interval of t, which is spline::in_intervals of an abscissa. Returns the
  /// interval.
  template <class Scalar>
  int take(int k, const Scalar* coefs, int count, double t) const {
    const int interval = spline::interval_of(count, t);
    take(k, coefs, count, interval);
    return interval;
  }
  /// The same for a caller that knows the interval.
  template <class Scalar>
  void take(int k, const Scalar* coefs, int count, int interval) const {
    if (start_[k] != interval) set(k, spline::cubic(coefs, count, interval), interval);
  }
  /// The same for a caller that knows that curve k has another, and its cubic.
  void set(int k, const spline::Cubic& cubic, int interval) const {
    for (int p = 0; p < 4; ++p) power_[p][k] = cubic.power[p];
    start_[k] = interval;
  }

  /// Curve k at t[k]. False where one of these is not in the curve's interval, or no number: its cubic is to be taken.
  bool values(const double (&t)[N], double (&value)[N]) const {
    double share[N];
    for (int k = 0; k < N; ++k) share[k] = t[k] - start_[k];
    at(share, value);
    int inside = 1;
    for (int k = 0; k < N; ++k) inside &= std::fabs(share[k] - 0.5) < 0.5 + kSlack ? 1 : 0;
    return inside != 0;
  }

  /// The same for a caller that knows that t is in the intervals.
  void known_values(const double (&t)[N], double (&value)[N]) const {
    double share[N];
    for (int k = 0; k < N; ++k) share[k] = t[k] - start_[k];
    at(share, value);
  }

  /// Of curve k: the interval taken, and what it is there.
  [[nodiscard]] int interval(int k) const { return static_cast<int>(start_[k]); }
  [[nodiscard]] spline::Cubic cubic(int k) const { return {{power_[0][k], power_[1][k], power_[2][k], power_[3][k]}}; }

private:
  static constexpr double kNone = -1e9;  // further than any argument goes

  void at(const double (&share)[N], double (&value)[N]) const {
    for (int k = 0; k < N; ++k) {
      const double v = share[k];
      value[k] = (power_[0][k] + v * power_[1][k]) + v * v * (power_[2][k] + v * power_[3][k]);
    }
  }

  mutable double start_[N];
  mutable double power_[4][N] = {};  ///< by powers of the share of the interval
};

}  // namespace palpate::runtime
