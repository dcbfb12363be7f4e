// SPDX-License-Identifier: MIT
// Where a contact that pulls harder than friction holds comes to rest.
#pragma once

#include "palpate/field.hpp"

#include <cmath>

namespace palpate::runtime {

/// The sideways deflection (m) at which the friction limit holds: c gives way against the force until then, from the
/// deflection `from` along `direction` (unit), that of the present sideways force. The force along that line never
/// grows on the way, so the root is bracketed. `scale` is the file's sideways scale (m).
[[nodiscard]] inline Vec3 slip(const Field& field, const DepthTerms& terms, double scale, const Vec3& from,
                               const Vec3& direction) {
  const auto excess = [&](double way) {
    return dot(terms.straight + field.sideways(terms, from + way * direction), direction) - terms.limit;
  };
  const double most = length(from) + 2 * scale;
  double low = 0, at_low = excess(0);
  // The slope at the start tells how far; a little more brackets the root, else the step doubles.
  const double probe = 1e-3 * scale, drop = at_low - excess(probe);
  double high = drop > 0 ? 1.0001 * probe * at_low / drop : most;
  high = high > 1e-6 * probe ? (high < most ? high : most) : 1e-6 * probe;
  double at_high = excess(high);
  while (at_high > 0 && high < most) {
    low = high;
    at_low = at_high;
    high *= 2;
    at_high = excess(high);
  }
  // The straight push alone is beyond the limit: c creeps on, tick by tick.
  if (at_high > 0) return from + (length(from) + 0.02 * scale) * direction;
  for (int i = 0; i < 24 && at_high < -1e-5 * terms.limit; ++i) {
    const double middle = i % 4 == 3 ? 0.5 * (low + high) : low + (high - low) * at_low / (at_low - at_high);
    const double value = excess(middle);
    if (value > 0) {
      low = middle;
      at_low = value;
    } else {
      high = middle;
      at_high = value;
    }
    if (high - low < 1e-9 * most) break;
  }
  return from + high * direction;
}

}  // namespace palpate::runtime
