// SPDX-License-Identifier: GPL-3.0-or-later
// How long a tick takes: random contacts of a response file, timed warm with Google Benchmark.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "palpate/palpate.hpp"

namespace palpate::cli {

/// Nanoseconds, ascending; not empty.
struct Times {
  std::vector<double> nanoseconds;
  /// share in [0, 1].
  [[nodiscard]] double quantile(double share) const;
};

/// Processor time of a tick, of each contact the least mean of a block of ticks: what others do on the machine (the
/// other half of a core above all, which the system counts as nobody's) disturbs the blocks by turns, never for less.
struct TickTimes : Times {
  double mean = 0;  ///< of all blocks, the median over the contacts
};

/// Each tick of strokes (in, aside, back, out) by the clock, its own time included.
struct EveryTick {
  Times all;          ///< of every tick
  Times undisturbed;  ///< of each that the strokes repeat, the least
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
  TickTimes field;   ///< of such a tick the blended responses' force alone, without pose, state and account (p amid a
                     ///< patch of the tool)
  TickTimes slide;   ///< dragged sideways, 2 % of the depth scale a tick
  TickTimes free;    ///< far from the body
  TickTimes locate;  ///< one search for the nearest point of the body
};

/// Throws as random_contacts does.
TickBench bench_ticks(const runtime::View& view, const TickBenchOptions& options);

/// Further times: the parts of a tick that are not warm or not alone, and other ways to the same force.
struct LatencyBench {
  int responses =
      0;            ///< that are interpolated: of three sites for each vertex of the tool's patch, in whose middle p is
  TickTimes blend;  ///< these interpolated and evaluated (full double interpolation), while c slides within its patch
  TickTimes anew;   ///< the same at 16 places in turn: all of it anew, of memory that is near
  TickTimes random;  ///< the same at places in random order of the body, or of a large one
  TickTimes five;    ///< five of the pressed contacts, a tick each
  TickTimes joint;   ///< the same five in one set, jointly where the file has a compliance
  EveryTick every;
  TickTimes plain;    ///< the formula as the paper writes it: every response evaluated, then the forces summed
  TickTimes network;  ///< a radial-basis network with 1000 centres
};

/// `large`: the body many times over (it has the tools of `view`), or `view` itself. `ticks`: how many of `every`, at
/// least 1. Throws as random_contacts does.
LatencyBench bench_latency(const runtime::View& view, const runtime::View& large, const TickBenchOptions& options,
                           std::uint64_t ticks);

/// Processor and number of processors, as the system names them.
std::string machine_name();

}  // namespace palpate::cli
