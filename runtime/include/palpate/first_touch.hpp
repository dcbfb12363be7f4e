// SPDX-License-Identifier: MIT
// Where a tool first touched between two ticks: what it did since is work of the hand, and counts.
#pragma once

#include "palpate/illinois.hpp"
#include "palpate/project.hpp"

#include <cmath>

namespace palpate::runtime {

/// How a contact begins.
struct FirstTouch {
  Projection foot;     ///< c
  Vec3 at;             ///< m, p when it came there
  double already = 0;  ///< m, of its depth then: no work of the hand
  bool late = true;    ///< no way was seen on which it came in
};

namespace detail {

/// m, by which a skin `probe` about a point reaches into the body at its foot. Where the smooth normals do not meet the
/// point, what counts is how far it is.
inline double overlap(const Projection& foot, double probe) {
  const double away = std::sqrt(foot.height * foot.height + foot.residual * foot.residual);
  return probe - std::copysign(away, foot.height);
}

}  // namespace detail

/// A point of a tool with a skin `probe` (m) about it went from one place to another since it was free, and overlaps
/// the body by `depth` (m, above 0) at `found` now. Where the surface near there was clear at first, the contact begins
/// where the skin came to it: a bracketed root, walks over a few triangles each. Else it overlapped before it was seen,
/// and what is deeper now counts alone. Out of line, for few ticks ask.
[[gnu::noinline]] inline FirstTouch first_touch(const View& view, const Projection& found, double depth, double probe,
                                                const Vec3& from, const Vec3& to) {
  constexpr int kMostSteps = 8;      // one or two on a smooth body
  constexpr double kExact = 1e-3;    // of the depth
  constexpr double kShallow = 0.02;  // of the depth scale
  // If the body is flat near c, the skin was above it by as much as this is below 0.
  const double flat = depth + dot(to - from, found.normal);
  // So shallow nothing is held sideways yet, and c is where it touched but for as little.
  if (flat <= 0 && depth < kShallow * view.meta->depth_scale) return {found, to, 0, false};
  FirstTouch touch{found, to, depth};
  Illinois root{0, flat, 1, depth};
  bool walked = false;
  BodyPoint clear = found.at;
  while (root.looks < kMostSteps) {
    if (!walked && (root.looks > 0 || !(root.at_low < 0))) {
      const Projection foot = project(view, clear, from);
      root.at_low = detail::overlap(foot, probe);
      if (root.at_low > 0) return {found, to, std::fmin(depth, std::fmax(root.at_low, flat)), true};
      clear = foot.at;
      walked = true;
    }
    // Walks start at the last foot from which the skin was clear: that side is met.
    const double share = root.next();
    const Vec3 q = from + share * (to - from);
    const Projection foot = project(view, clear, q);
    const double over = detail::overlap(foot, probe);
    const bool exact = std::fabs(over) <= kExact * depth;
    if (over > 0 || exact) {
      touch = {foot, q, std::fmax(0, probe - foot.height), false};
      if (exact) break;
    } else {
      clear = foot.at;
      walked = true;
    }
    root.narrow(share, over);
  }
  touch.late = false;
  // An overlap grows no faster than the point moves. Where it does the foot leapt, or none was found, as at an edge: c
  // is where the foot is now, and what counts is how far the tool went in there.
  const Vec3 way = to - touch.at;
  if (!touch.foot.converged || depth - touch.already > (1 + kExact) * length(way)) {
    touch.foot = found;
    touch.at = to;
    touch.already = std::fmax(0, depth + std::fmin(0, dot(way, found.normal)));
  }
  return touch;
}

}  // namespace palpate::runtime
