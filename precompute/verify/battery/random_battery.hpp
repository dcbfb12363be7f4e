// SPDX-License-Identifier: GPL-3.0-or-later
// Solves random cells at their default settings and judges each by a much finer mesh.
#pragma once

#include "precompute/verify/battery/battery_cell.hpp"

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace palpate::verify {

struct RandomBatteryOptions {
  double tolerance = 0.03;  ///< relative error of a force that is right whatever its estimate says
  double estimates = 2.0;   ///< errors up to this many of their estimates are right, too
  double refine = 0.5;      ///< factor of edges and growth of the finer mesh, (0, 1)
  unsigned threads = 1;
};

/// right: accepted, every force within the options' bounds. wrong: accepted, a force beyond them. refused: both meshes
/// refuse. refused_sound: the finer mesh solves it. open: accepted, but the finer mesh refuses.
enum class Verdict { right, wrong, refused, refused_sound, open };
const char* verdict_name(Verdict verdict);

/// A force beside that of the finer mesh, both relative to the latter.
struct JudgedSample {
  double error = 0.0;     ///< |F - F'| / |F'|
  double estimate = 0.0;  ///< of F alone
};

struct JudgedCell {
  CellSolve solve;
  Verdict verdict = Verdict::open;
  std::vector<JudgedSample> samples;  ///< of an accepted cell, those that the finer mesh has
  double excess = 0.0;                ///< largest error over what is allowed; wrong: > 1
  std::vector<Sample> reference;      ///< of the finer mesh
  std::string reference_cause;        ///< why it has no answer
  double reference_seconds = 0.0;     ///< of processor time
  std::uint32_t reference_nodes = 0;
};

JudgedCell judge_cell(const BatteryCell& cell, const RandomBatteryOptions& options);

/// The same by solves that are there.
JudgedCell judge(CellSolve solve, const CellSolve& reference, const RandomBatteryOptions& options);

/// Judges all; `done` is called with every judged cell's number as it is there, by one thread at a time. Stopped: fewer
/// calls. Throws as solve_cell does.
void run_random_battery(const std::vector<BatteryCell>& cells, const RandomBatteryOptions& options,
                        const std::function<void(std::size_t number, const JudgedCell& judged)>& done);

/// Quantiles of a figure.
struct Spread {
  double median = 0.0, p95 = 0.0, worst = 0.0;
};

struct RandomFigures {
  std::map<Verdict, std::size_t> verdicts;
  std::size_t cells = 0;
  std::size_t samples = 0, covered = 0;  ///< compared forces; those whose error is at most the estimate
  Spread error, estimate;                ///< relative, of the compared forces
  Spread ratio;                          ///< estimate over error
  Spread seconds, megabytes;             ///< of the cells' solves (s of processor time, MB)

  [[nodiscard]] double coverage() const { return samples > 0 ? double(covered) / double(samples) : 0.0; }
};

RandomFigures random_figures(const std::vector<JudgedCell>& cells);

}  // namespace palpate::verify
