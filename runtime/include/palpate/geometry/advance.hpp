// SPDX-License-Identifier: MIT
// A point of the surface that follows a target at a bounded rate.
#pragma once

#include "palpate/geometry/closest_point.hpp"

namespace palpate::runtime {

/// Moves a point of the surface from `from` towards `target`, the point of the surface that it is to reach, by at most
/// `reach` (m). `closest(p)` returns the Location closest to a point. A target beyond reach is approached along the
/// straight line; where the surface near that line's point is farther away than kMostDetour reaches, as between the
/// walls of a fold, the point stays.
template <class ClosestTo>
inline Location advance(const Location& from, const Location& target, double reach, const ClosestTo& closest) {
  constexpr double kMostDetour = 3;
  const Vec3 way = target.point - from.point;
  const double distance = length(way);
  if (!(distance > reach)) return target;
  if (!(reach > 0)) return from;
  const Location part = closest(from.point + (reach / distance) * way);
  return length(part.point - from.point) <= kMostDetour * reach ? part : from;
}

}  // namespace palpate::runtime
