// SPDX-License-Identifier: GPL-3.0-or-later
// Singular functions, continued by their parabola where no valid state lies, because a line search may step there.
#pragma once

#include <cmath>

namespace palpate::fem {

/// A function and its two derivatives.
struct Guarded {
  double value, first, second;
};

/// Smallest dilatation or squared stretch at which powers are followed.
inline constexpr double kFlattest = 0.1;

inline Guarded parabola(const Guarded& at, double step) {
  return {at.value + step * (at.first + 0.5 * step * at.second), at.first + step * at.second, at.second};
}

/// exp(x), a parabola beyond x = 30.
inline Guarded guarded_exp(double x) {
  constexpr double kMost = 30;
  const double e = std::exp(x < kMost ? x : kMost);
  const Guarded at{e, e, e};
  return x < kMost ? at : parabola(at, x - kMost);
}

/// x^n, a parabola below x = low > 0.
inline Guarded guarded_power(double x, double n, double low) {
  const double y = x > low ? x : low, p = std::pow(y, n);
  const Guarded at{p, n * p / y, n * (n - 1) * p / (y * y)};
  return x > low ? at : parabola(at, x - low);
}

}  // namespace palpate::fem
