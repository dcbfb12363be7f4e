// SPDX-License-Identifier: MIT
// First touch of a moving tool by conservative advancement (Mirtich 1996).
#pragma once

#include "palpate/geometry/tool_shape.hpp"

namespace palpate::runtime {

/// First touch of a tool on its way.
struct Sweep {
  bool touches = false;
  double share = 0;  ///< [0, 1] of the way
  Pose pose;         ///< there
  ToolTouch touch;   ///< there; at the end of the way where it does not touch
};

/// Most steps of a sweep.
inline constexpr int kSweepSteps = 16;

/// The tool goes straight from one pose to another. `first`: the search at `from`, or one whose clearance is no larger.
/// `extent` (m): of the tool about its origin. `search(pose, near)` returns the ToolTouch at a pose.
/// Each step goes on by the clearance over the largest travel of the tool, so nothing is passed; a sweep that is not at
/// the end after kSweepSteps steps (a grazing tool) goes on in the next tick. It touches where the clearance is at
/// most `tolerance` (m).
template <class SearchAt>
PALPATE_NOINLINE inline Sweep sweep(const Pose& from, const Pose& to, const ToolTouch& first, double extent,
                                    double tolerance, const SearchAt& search) {
  const double way = travel(from, to, extent);
  Sweep sweep;
  sweep.touch = first;
  sweep.pose = from;
  for (int step = 0; step < kSweepSteps; ++step) {
    if (!(sweep.touch.clearance > tolerance)) {
      sweep.touches = true;
      return sweep;
    }
    if (sweep.share == 1) return sweep;
    sweep.share = way > 0 ? smaller(1.0, sweep.share + sweep.touch.clearance / way) : 1;
    sweep.pose = sweep.share == 1 ? to : between(from, to, sweep.share);
    sweep.touch = search(sweep.pose, sweep.touch.body.at);
  }
  return sweep;
}

}  // namespace palpate::runtime
