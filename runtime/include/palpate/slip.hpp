// SPDX-License-Identifier: MIT
// Where a contact that pulls harder than friction holds comes to rest.
#pragma once

#include "palpate/field.hpp"

#include <cmath>

namespace palpate::runtime {

struct Slipped {
  Vec3 deflection;    ///< m
  Vec3 force;         ///< N, sideways, there; of a leap, about
  bool holds = true;  ///< there; else no deflection was found at which friction does
};

/// Whatever slips of a contact: `straight` (N) is the sideways force that it bears of a straight push, `limit` (N) what
/// friction holds about `centre` (N), `scale` the file's sideways scale (m).
struct Slips {
  Part part;
  Vec3 straight, centre;
  double limit, scale;
  bool at_once;  ///< what lies across the line counts in the limit: there is no next tick of sliding to come to rest in
  bool dear;     ///< to ask for a force is: of a leap a guess has to do sooner
  bool nearly;   ///< where it is, some of the excess may stay for the next tick
};

/// The sideways deflection at which friction holds: the anchor gives way against what friction bears until then, from
/// the deflection `from` (m) and its sideways force (N), that of the straight push included. The force along that line
/// never grows on the way, so the root is bracketed.
template <class AnyField>
[[nodiscard]] inline Slipped slip(const AnyField& field, const DepthTerms& terms, const Slips& what, const Vec3& from,
                                  const Vec3& force) {
  // A hair below the limit: that is met from either side. Of the limit, that may stay where looks are dear.
  constexpr double kHair = 5e-6, kStays = 4e-4;
  // Of a leap, by more of the scale than this at once: what is left of the excess, where it is a limit; how many limits
  // it may be before a guess has to do, and, where looks are dear, how much of it one may leave for a line to do. How
  // much of what is across the line may be left along it.
  constexpr double kLeap = 0.05, kLeft = 1e-3, kNear = 0.5, kAcross = 0.75;
  const double most_limits = what.dear ? 1 : 10;
  const double limit = (1 - kHair) * what.limit, hair = (what.dear && what.nearly ? kStays : kHair) * what.limit,
               scale = what.scale;
  const Vec3 friction = force - what.centre;
  const double size = length(friction), reach = length(from), most = reach + 2 * scale;
  const Vec3 direction = (1 / size) * friction;
  const coupled::Vec2 start = field.in_plane(from), line = field.in_plane(direction),
                      off_centre = field.in_plane(what.straight - what.centre);
  double low = 0, at_low = size - limit;
  // A line from no force at no deflection falls short of the root, as forces rise less and less; it is near enough to
  // tell how far that is: a little more brackets it, or meets it. What falls short twice, and not by much less, is
  // doubled.
  const double guess = reach * at_low / size;
  // Where c goes on, the place that it comes to has the last word: of a leap it suffices to know about how far it goes.
  const bool leaps = !what.at_once && guess > kLeap * scale;
  if (leaps && at_low > most_limits * limit) return {from + guess * direction, what.centre + limit * direction, true};
  double close = leaps ? std::fmax(hair, kLeft * at_low * at_low / limit) : hair;
  coupled::Vec2 pull{};  // less the centre
  const auto excess = [&](double way) {
    pull = off_centre + field.sideways(terms, start + way * line, what.part);
    const double along = dot(pull, line);
    if (!what.at_once) return along - limit;
    const double across = dot(pull, pull) - along * along, left = limit * limit - across;
    // What is across more than friction holds gives way next, along a line of its own.
    close = left > 0 ? hair : kAcross * std::sqrt(across);
    return along - (left > 0 ? std::sqrt(left) : 0);
  };
  double high = guess > 1e-9 * scale ? (guess < most ? guess : most) : 1e-3 * scale;
  double at_high = excess(high), third = low, at_third = at_low;
  const auto there = [&](double way, bool holds) -> Slipped {
    return {from + way * direction, what.centre + field.in_space(pull), holds};
  };
  if (leaps && what.dear && at_high < kNear * at_low) {
    const double root = at_low / (at_low - at_high) * high;
    pull = (limit / (limit + at_high)) * pull;
    return there(root < most ? root : most, true);
  }
  for (int turn = 0; at_high > close && high < most; ++turn) {
    const double drop = at_low - at_high, root = drop > 0 ? high + 1.0001 * (high - low) * at_high / drop : most;
    const double next = turn < 2 || at_high < 0.1 * at_low ? root : 2 * high;
    third = low;
    at_third = at_low;
    low = high;
    at_low = at_high;
    high = next < most ? next : most;
    at_high = excess(high);
  }
  if (at_high > close) {
    // The straight push alone is beyond one and a half limits: the anchor creeps on, tick by tick.
    high = reach + 0.02 * scale;
    excess(high);
    return there(high, false);
  }
  if (at_high >= -close) return there(high, true);
  // Chandrupatla's rule (Advances in Engineering Software 28, 1997): the parabola through the last three points, laid
  // down, where it is sure to be monotonic between them, else halves.
  double last = low, at_last = at_low, other = high, at_other = at_high;
  for (int i = 0; i < 24 && std::fabs(last - other) > 1e-9 * most; ++i) {
    const double xi = (last - other) / (third - other), phi = (at_last - at_other) / (at_third - at_other);
    double share = 0.5;  // of the way from the last to the other
    if (third == last) {
      share = at_last / (at_last - at_other);
    } else if (phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi) {
      share = at_last / (at_other - at_last) * at_third / (at_other - at_third) +
              (third - last) / (other - last) * at_last / (at_third - at_last) * at_other / (at_third - at_other);
    }
    const double next = last + share * (other - last), at_next = excess(next);
    if ((at_next > 0) == (at_last > 0)) {
      third = last;
      at_third = at_last;
    } else {
      third = other;
      at_third = at_other;
      other = last;
      at_other = at_last;
    }
    last = next;
    at_last = at_next;
    if (std::fabs(at_next) <= close) return there(next, true);
  }
  if (at_last > 0) excess(last = other);
  return there(last, true);
}

}  // namespace palpate::runtime
