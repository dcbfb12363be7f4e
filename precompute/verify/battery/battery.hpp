// SPDX-License-Identifier: GPL-3.0-or-later
// Runs stiff cells and checks a seeded share of the converged ones against finer meshes, or another contact.
#pragma once

#include "precompute/verify/battery/battery_cell.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate::verify {

struct BatteryOptions {
  std::uint64_t seed = 1;
  double verified_share = 0.2;  ///< of the converged cells of every family, [0, 1]; one that cannot be is replaced
  double tolerance = 0.05;      ///< largest relative difference to the check, over the deeper half of the curve
  double limit = 600.0;         ///< s that a cell may take; one that takes longer is an error of the solver
  unsigned threads = 1;
  std::function<void(std::size_t done, std::size_t total)> progress;
};

struct CellResult : CellSolve {
  std::optional<double> difference;  ///< to the check; none: not drawn, or not checked
  bool augmented = false;            ///< the check was the augmented-Lagrange solve
  std::size_t compared = 0;          ///< samples that the check had a partner for ...
  std::size_t within_estimate = 0;   ///< ... of which this many differ by no more than their error estimates
  std::string check_cause;           ///< why a drawn cell could not be checked by a finer mesh, or at all
};

struct BatteryResult {
  std::vector<CellResult> cells;  ///< as many as were given
};

/// solve_cell for every cell; the check has elements at most 0.6 times as large that grow
/// slower, and at least 1.3 times the nodes; where no such mesh is solved, it is the augmented-Lagrange solve on the
/// cell's own. Throws as solve_cell does.
BatteryResult run_battery(const std::vector<BatteryCell>& cells, const BatteryOptions& options);

/// A table's figures of a set of cells.
struct BatteryFigures {
  std::size_t cells = 0, converged = 0, core = 0, core_converged = 0;
  std::size_t verified = 0, augmented = 0, wrong = 0, unchecked = 0;  ///< of the drawn ones
  std::size_t compared = 0, within_estimate = 0;                      ///< samples, see CellResult
  double slowest = 0.0;                                               ///< s
};

/// `family` empty: of all.
BatteryFigures battery_figures(const std::vector<BatteryCell>& cells, const BatteryResult& result, double tolerance,
                               const std::string& family = {});

}  // namespace palpate::verify
