// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/bench_rows.hpp"

#include "formats/io/error.hpp"
#include "tools/bench/plate_rows.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

namespace palpate::cli {
namespace {

constexpr int kRepeats = 3;  // of a tick, from the same forces

/// The gaps of the motion at a tick: the periods of pressing and of going aside have no common multiple.
Plate::Values gaps_at(const Plate& plate, std::size_t tick) {
  const double t = 1e-3 * static_cast<double>(tick);
  return plate.gaps(1.5e-3 * (1 - std::cos(60 * t)), 1e-3 * std::sin(41 * t));
}

RowsBenchRow bench_sweeps(const RowsBenchOptions& options, int sweeps) {
  using Clock = std::chrono::steady_clock;
  const Plate plate;
  const auto rows = std::make_unique<Plate::Rows>();
  if (const char* cause = plate.fill(*rows)) throw Error(ExitCode::numerical, cause);
  RowsBenchRow row;
  row.sweeps = sweeps;
  row.all.nanoseconds.reserve(options.ticks);
  row.undisturbed.nanoseconds.reserve(options.ticks);
  const std::size_t step = std::max<std::size_t>(1, options.ticks / options.references);
  Plate::Values force{};
  std::size_t reported = 0, wrong = 0;
  for (std::size_t k = 0; k < options.ticks; ++k) {
    const Plate::Values gaps = gaps_at(plate, k), last = force;
    runtime::RowsOutcome outcome;
    double least = HUGE_VAL;
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
      force = last;
      const auto begin = Clock::now();
      outcome = rows->solve(gaps.data(), force.data(), sweeps);
      const double time = std::chrono::duration<double, std::nano>(Clock::now() - begin).count();
      if (repeat == 0) row.all.nanoseconds.push_back(time);
      least = std::min(least, time);
    }
    row.undisturbed.nanoseconds.push_back(least);
    reported += outcome.converged() ? 0 : 1;
    if (k % step != 0) continue;
    const Plate::Values exact = Plate::converged(*rows, gaps, force);
    if (!(Plate::force(exact)[0] > 0)) continue;
    row.errors.push_back(Plate::difference(force, exact));
    wrong += row.errors.back() > 0.01 && outcome.converged() ? 1 : 0;
  }
  std::sort(row.errors.begin(), row.errors.end());
  for (Times* times : {&row.all, &row.undisturbed}) std::sort(times->nanoseconds.begin(), times->nanoseconds.end());
  row.reported = static_cast<double>(reported) / static_cast<double>(options.ticks);
  row.wrong = static_cast<double>(wrong) / static_cast<double>(row.errors.size());
  return row;
}

}  // namespace

std::vector<RowsBenchRow> bench_rows(const RowsBenchOptions& options) {
  std::vector<RowsBenchRow> rows;
  for (const int sweeps : options.sweeps) {
    if (options.progress) options.progress(sweeps);
    rows.push_back(bench_sweeps(options, sweeps));
  }
  return rows;
}

}  // namespace palpate::cli
