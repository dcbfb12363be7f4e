// SPDX-License-Identifier: MIT
// Where a contact that pulls harder than friction holds comes to rest.
#pragma once

#include "palpate/field.hpp"

#include <cmath>

namespace palpate::runtime {

struct Slipped {
  Vec3 deflection;    ///< m
  bool holds = true;  ///< there; else no deflection was found at which friction does
};

/// Whatever slips of a contact: `straight` (N) is the sideways force that it bears of a straight push, `limit` (N) what
/// friction holds, `scale` the file's sideways scale (m).
struct Slips {
  Part part;
  Vec3 straight;
  double limit, scale;
  bool at_once;  ///< what lies across the line counts in the limit: there is no next tick of sliding to come to rest in
};

/// The sideways deflection at which friction holds: the anchor gives way against the force until then, from the
/// deflection `from` (m) and its sideways force (N), that of the straight push included. The force along that line
/// never grows on the way, so the root is bracketed.
template <class AnyField>
[[nodiscard]] inline Slipped slip(const AnyField& field, const DepthTerms& terms, const Slips& what, const Vec3& from,
                                  const Vec3& force) {
  const double limit = what.limit, scale = what.scale;
  const Vec3 direction = (1 / length(force)) * force;
  const auto excess = [&](double way) {
    const Vec3 pull = what.straight + field.sideways(terms, from + way * direction, what.part);
    const double along = dot(pull, direction);
    if (!what.at_once) return along - limit;
    const double left = limit * limit - (dot(pull, pull) - along * along);
    return along - (left > 0 ? std::sqrt(left) : 0);
  };
  const double most = length(from) + 2 * scale;
  double low = 0, at_low = dot(force, direction) - limit;
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
  // The straight push alone is beyond the limit: the anchor creeps on, tick by tick.
  if (at_high > 0) return {from + (length(from) + 0.02 * scale) * direction, false};
  // The Illinois rule (Dowell and Jarratt, BIT 11, 1971): an end that stays twice running counts half, or it would stay
  // for good. Halves now and then, for the worst.
  double reached = at_high;
  for (int i = 0, stayed = 0; i < 24 && reached < -1e-5 * limit; ++i) {
    const double middle = i % 8 == 7 ? 0.5 * (low + high) : low + (high - low) * at_low / (at_low - at_high);
    const double value = excess(middle);
    if (value > 0) {
      low = middle;
      at_low = value;
      if (stayed > 0) at_high *= 0.5;
      stayed = 1;
    } else {
      high = middle;
      at_high = reached = value;
      if (stayed < 0) at_low *= 0.5;
      stayed = -1;
    }
    if (high - low < 1e-9 * most) break;
  }
  return {from + high * direction};
}

}  // namespace palpate::runtime
