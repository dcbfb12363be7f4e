// SPDX-License-Identifier: GPL-3.0-or-later
// How long a tick takes: random contacts of a response file, timed warm with Google Benchmark.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "palpate/runtime.hpp"

namespace palpate::cli {

/// Processor time over the contacts, each the mean of many ticks.
struct TickTimes {
  std::vector<double> nanoseconds;  ///< ascending, one a contact; not empty
  /// share in [0, 1].
  [[nodiscard]] double quantile(double share) const;
};

struct TickBenchOptions {
  std::uint32_t tool = 0;
  int contacts = 40;  ///< at least 1
  std::uint32_t seed = 1;
  double seconds = 0.02;  ///< measured for each contact and state
};

struct TickBench {
  int contacts = 0;  ///< that were made
  TickTimes press;   ///< pushed in and out where it touched: sticking, with friction
  TickTimes field;   ///< of such a tick the blended responses' force alone, without pose, state and account
  TickTimes slide;   ///< dragged sideways, 2 % of the depth scale a tick
  TickTimes free;    ///< far from the body
  TickTimes locate;  ///< one search for the nearest point of the body
};

/// Draws contact points uniformly over the body's area (without what was not sampled), presses the tool in along
/// n(c) to a random depth and times ticks there. Throws Error(bad_input) when no contact can be made.
TickBench bench_ticks(const runtime::View& view, const TickBenchOptions& options);

/// Processor and number of processors, as the system names them.
std::string machine_name();

}  // namespace palpate::cli
