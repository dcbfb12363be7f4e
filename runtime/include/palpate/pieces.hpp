// SPDX-License-Identifier: MIT
// Splines that are asked again and again nearly where they were asked before: as a contact asks from tick to tick.
#pragma once

#include "palpate/spline.hpp"

namespace palpate::runtime {

/// N splines of one length, each remembered as a cubic on the knot interval that was last asked for. The coefficients
/// stay with the caller: curve k's begin at coefs + k * count. Not for several threads at once.
template <int N>
class Pieces {
public:
  /// Other coefficients from now on.
  void forget() {
    for (double& start : start_) start = kNone;
  }

  /// Curve k at t[k], which is spline::in_intervals of its abscissa.
  template <class Scalar>
  void values(const Scalar* coefs, int count, const double (&t)[N], double (&value)[N]) const {
    double share[N];
    bool inside = true;
    for (int k = 0; k < N; ++k) {
      share[k] = t[k] - start_[k];
      inside = inside && share[k] > -kSlack && share[k] < 1 + kSlack;
    }
    if (!inside) take(coefs, count, t, share);
    for (int k = 0; k < N; ++k) {
      const double v = share[k];
      value[k] = (power_[0][k] + v * power_[1][k]) + v * v * (power_[2][k] + v * power_[3][k]);
    }
  }

private:
  static constexpr double kNone = -8;
  /// Just outside its interval a cubic is that of the next up to the third power of this: a deflection that trembles
  /// about a knot, as one of zero does, must not ask for another cubic every tick.
  static constexpr double kSlack = 1e-6;

  // Out of line: rarely called, and long.
  template <class Scalar>
  [[gnu::noinline]] void take(const Scalar* coefs, int count, const double (&t)[N], double (&share)[N]) const {
    for (int k = 0; k < N; ++k) {
      const int interval = spline::interval_of(count, t[k]);
      const spline::Cubic cubic = spline::cubic(coefs + k * count, count, interval);
      for (int p = 0; p < 4; ++p) power_[p][k] = cubic.power[p];
      start_[k] = interval;
      share[k] = t[k] - start_[k];
    }
  }

  mutable double start_[N];
  mutable double power_[4][N];
};

}  // namespace palpate::runtime
