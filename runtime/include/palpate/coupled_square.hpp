// SPDX-License-Identifier: MIT
// The anchor rule of laws of degree 2 as it mostly goes, for one part of a contact or for two side by side.
#pragma once

#include "palpate/coupled_energy.hpp"
#include "palpate/lanes.hpp"

namespace palpate::coupled {

inline constexpr int kMostGivings = 2;  ///< times that an anchor gives way after a step

}  // namespace palpate::coupled

/// In the words of coupled.hpp, of one number or of Two. `lean`: how many times as much a part of the contact bears of
/// the straight push's sideways force.
namespace palpate::coupled::square {

/// What the anchor rule asks for at one depth and deflection where r is at most |T| h.
template <class Number>
struct Load {
  Vec2Of<Number> force;  ///< T (N)
  Number energy;         ///< W less the integral of F (N)
  Number power;          ///< what the hand does on the way without F, by t (N)
  Number over;           ///< above 0 where r is more than |T| h, and all this is wrong
  [[nodiscard]] bool covered() const { return !runtime::any_above_zero(over); }
};
template <class Number>
[[nodiscard]] inline Load<Number> load(const AtDepth& d, const Vec2Of<Number>& u, const Number& lean) {
  const Vec2Of<Number> stiff = times(d.energy.square, u), rise = times(d.rate.square, u);
  const Vec2Of<Number> straight{d.straight.x * lean, d.straight.y * lean}, force = straight + stiff;
  const Quotient<Number> moved = quotient(d.energy.square, rise);
  const Number bend = dot(u, times(d.coupling, u));
  const Number loss = moved.by * runtime::positive(0.5 * dot(u, rise) - d.s * bend);
  return {force, dot(straight, u) + 0.5 * dot(u, stiff), d.s * (2.0 * lean * dot(d.slope, u) + bend),
          loss * loss - dot(force, force) * dot(moved.of, moved.of)};
}

/// u at another depth such that T - g stays, and what of u lies where nothing resists.
template <class Number>
[[nodiscard]] inline Vec2Of<Number> held(const AtDepth& from, const AtDepth& to, const Vec2Of<Number>& u) {
  const Quotient<Number> less = quotient(to.energy.square, times(to.energy.square, u) - times(from.energy.square, u));
  return u - (1 / less.by) * less.of;
}

/// u after the tool went deeper by one `step` of t. False, and u as it was, where r is more than |T| h or the anchor
/// has to give way otherwise than along the mean of T.
template <class Number>
[[nodiscard]] inline bool deepen(double step, const AtDepth& from, const AtDepth& to, Vec2Of<Number>& u,
                                 const Number& lean) {
  const Load<Number> first = load(from, u, lean);
  if (!first.covered()) return false;
  Vec2Of<Number> end = held(from, to, u);
  for (int k = 0;; ++k) {
    const Load<Number> last = load(to, end, lean);
    if (!last.covered()) return false;
    const Number lacks = runtime::positive(last.energy - first.energy - 0.5 * step * (first.power + last.power));
    if (k == kMostGivings || !runtime::any_above_zero(lacks)) break;
    const Vec2Of<Number> mean = 0.5 * (first.force + last.force);
    const Number slope = dot(mean, last.force), bend = dot(mean, times(to.energy.square, mean));
    const Number rest = slope * slope - 2.0 * bend * lacks;
    if (!runtime::all_above_zero(slope - 0.5 * dot(last.force, last.force)) || !runtime::all_above_zero(rest)) {
      return false;
    }
    const Number way = 2.0 * lacks / (slope + runtime::square_root(rest));
    end = {end.x - way * mean.x, end.y - way * mean.y};
  }
  u = end;
  return true;
}

}  // namespace palpate::coupled::square
