// SPDX-License-Identifier: GPL-3.0-or-later
// Closed motions of a contact that sticks, from no depth to none, through the coupled model's anchor rule: what the
// hand gets back, with no account or friction to forgive it.
#pragma once

#include <cstdint>
#include <vector>

#include "palpate/palpate.hpp"

namespace palpate::cli {

/// A leg: sideways by (x, y) sideways scales, then to another depth, by its abscissa t.
struct MotionLeg {
  double x = 0, y = 0, t = 0;
};

struct ClosedMotionsOptions {
  std::uint64_t motions = 100000;  ///< random ones
  int searches = 200;              ///< from random ones on towards the least work
  std::uint64_t seed = 1;
};

struct ClosedMotionsReport {
  std::uint64_t motions = 0;       ///< played, those of the searches not counted
  double worst = 0, searched = 0;  ///< least work over gross work, of the random ones and of the searches
};

/// On fields blended at random points of the file's body and tools. The file's model is the coupled one (or a spring).
/// Throws Error(bad_input) where it is not.
ClosedMotionsReport play_closed_motions(const runtime::View& view, const ClosedMotionsOptions& options);

}  // namespace palpate::cli
