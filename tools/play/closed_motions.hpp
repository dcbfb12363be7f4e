// SPDX-License-Identifier: GPL-3.0-or-later
// Closed motions of a contact, from no depth to none: the least work of the hand, as a share of what went through it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "palpate/palpate.hpp"

namespace palpate::cli {

/// A leg: to a tangential place (depth scales) and a depth, by its abscissa t = sqrt(depth / Z).
struct MotionLeg {
  double x = 0, y = 0, t = 0;
};

struct ClosedMotionsOptions {
  std::uint64_t motions = 100000;  ///< random ones
  int searches = 200;              ///< descents from random ones towards the least work
  std::uint64_t seed = 1;
  /// Called after each tenth of the motions and of the searches; may be empty.
  std::function<void(const char* what, std::uint64_t done, std::uint64_t total)> progress;
};

struct ClosedMotionsReport {
  std::uint64_t motions = 0;       ///< played, those of the searches not counted
  double worst = 0, searched = 0;  ///< least work over gross work, of the random ones and of the searches
};

/// At random points of the file's body, with random tools of the file.
ClosedMotionsReport play_closed_motions(const runtime::View& view, const ClosedMotionsOptions& options);

}  // namespace palpate::cli
