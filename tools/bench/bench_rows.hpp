// SPDX-License-Identifier: GPL-3.0-or-later
// Error and time of a solve of 120 rows against the number of sweeps.
#pragma once

#include "tools/bench/tick_bench.hpp"

#include <cstddef>
#include <functional>
#include <vector>

namespace palpate::cli {

struct RowsBenchOptions {
  std::vector<int> sweeps{1, 2, 3, 4, 5, 6, 8, 12, 16};
  std::size_t ticks = 1000000;    ///< of the motion, each timed alone, >= 1
  std::size_t references = 2000;  ///< of these, evenly spaced, that are compared with a converged solve, >= 1
  std::function<void(int sweeps)> progress;  ///< called before each number of sweeps; may be empty
};

/// One number of sweeps.
struct RowsBenchRow {
  int sweeps = 0;
  std::vector<double> errors;  ///< of the plate's force, relative to the converged one, ascending
  double reported = 0;         ///< share of the ticks whose estimate was above 1 %
  double wrong = 0;            ///< share of the references off by more than 1 % whose estimate was below
  Times all;                   ///< of every tick, the clock's own time included
  Times undisturbed;           ///< the least of three solves of the tick, each from the same forces
};

/// The plate of plate_rows.hpp, pressed by up to 3 mm and moved aside by up to 1 mm at up to 0.1 m/s, at 1 kHz, each
/// solve from the forces of the last.
std::vector<RowsBenchRow> bench_rows(const RowsBenchOptions& options);

}  // namespace palpate::cli
