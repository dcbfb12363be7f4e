// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/battery/battery.hpp"

#include "precompute/bake/parallel.hpp"
#include "precompute/common/random_subset.hpp"
#include "precompute/solve/pair/sample_difference.hpp"

#include <algorithm>
#include <map>
#include <mutex>

namespace palpate::verify {
namespace {

void compare(CellResult& result, const CellSolve& other) {
  result.check_cause = other.cause;
  if (!other.accepted) return;
  const solve::SampleDifference d = solve::sample_difference(result.samples, other.samples);
  if (d.compared == 0) {
    result.check_cause = "no sample of the check matches";
    return;
  }
  result.difference = std::max(d.normal, d.tangential);
  result.compared = d.compared;
  result.within_estimate = d.within_estimate;
  result.check_cause.clear();
}

// Elements at most 0.6 times as large; a cell that converged on a finer rung of the ladder needs smaller ones still.
void check(const BatteryCell& cell, CellResult& result) {
  constexpr double kMoreNodes = 1.3;
  for (const double refine : {0.6, 0.36}) {
    const CellSolve fine = solve_cell(cell, [&](solve::PairOptions& options, solve::PairPath&, const Body& body) {
      options = solve::finer_options(options, body, refine);
      solve::without_limits(options);
    });
    if (fine.accepted && fine.nodes < kMoreNodes * result.nodes) {
      result.check_cause = "the check's mesh is hardly finer";
      continue;
    }
    compare(result, fine);
    break;
  }
  if (result.difference) return;
  const std::string finer = result.check_cause;
  compare(result, solve_cell(cell, [](solve::PairOptions& options, solve::PairPath&, const Body&) {
            options.method = solve::ContactMethod::augmented;
            solve::without_limits(options);
          }));
  result.augmented = result.difference.has_value();
  result.check_cause = result.augmented ? finer : finer + "; augmented Lagrange: " + result.check_cause;
}

// A share of the converged cells of every family, at least one. A cell that cannot be checked is reported, and another
// cell drawn in its place as long as there are any.
class Draws {
public:
  Draws(const std::vector<BatteryCell>& cells, const BatteryResult& result, const BatteryOptions& options) {
    std::map<std::string, std::vector<std::size_t>> converged;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      if (result.cells[k].accepted) converged[cells[k].family].push_back(k);
    }
    for (const auto& [family, numbers] : converged) {
      Family drawn;
      drawn.wanted = random_subset(numbers.size(), options.verified_share, options.seed).size();
      for (const std::size_t k : random_subset(numbers.size(), 1.0, options.seed)) drawn.order.push_back(numbers[k]);
      families_.push_back(std::move(drawn));
    }
  }

  // The cells to check next; empty: enough are, or there are no more.
  std::vector<std::size_t> next(const BatteryResult& result) {
    std::vector<std::size_t> cells;
    for (Family& f : families_) {
      const auto checked = std::count_if(f.order.begin(), f.order.begin() + static_cast<std::ptrdiff_t>(f.drawn),
                                         [&](std::size_t k) { return result.cells[k].difference.has_value(); });
      for (auto missing = f.wanted - static_cast<std::size_t>(checked); missing > 0 && f.drawn < f.order.size();
           --missing) {
        cells.push_back(f.order[f.drawn++]);
      }
    }
    return cells;
  }

private:
  struct Family {
    std::vector<std::size_t> order;
    std::size_t wanted = 0, drawn = 0;
  };
  std::vector<Family> families_;
};

}  // namespace

BatteryResult run_battery(const std::vector<BatteryCell>& cells, const BatteryOptions& options) {
  BatteryResult result;
  result.cells.resize(cells.size());
  std::size_t done = 0;
  std::mutex guard;
  const auto report = [&](std::size_t total) {
    const std::lock_guard lock(guard);
    ++done;
    if (options.progress) options.progress(done, total);
  };
  bake::parallel_for(cells.size(), options.threads, [&](std::size_t k) {
    static_cast<CellSolve&>(result.cells[k]) = solve_cell(cells[k]);
    report(cells.size());
  });
  Draws draws(cells, result, options);
  std::size_t total = cells.size();
  for (auto drawn = draws.next(result); !drawn.empty(); drawn = draws.next(result)) {
    total += drawn.size();
    bake::parallel_for(drawn.size(), options.threads, [&](std::size_t k) {
      check(cells[drawn[k]], result.cells[drawn[k]]);
      report(total);
    });
  }
  return result;
}

BatteryFigures battery_figures(const std::vector<BatteryCell>& cells, const BatteryResult& result, double tolerance,
                               const std::string& family) {
  BatteryFigures f;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (!family.empty() && cells[k].family != family) continue;
    const CellResult& cell = result.cells[k];
    ++f.cells;
    f.converged += cell.accepted;
    f.core += cells[k].core;
    f.core_converged += cells[k].core && cell.accepted;
    f.unchecked += !cell.difference && !cell.check_cause.empty();
    f.verified += cell.difference && *cell.difference <= tolerance;
    f.augmented += cell.augmented;
    f.compared += cell.compared;
    f.within_estimate += cell.within_estimate;
    f.wrong += cell.difference && !(*cell.difference <= tolerance);
    f.slowest = std::max(f.slowest, cell.seconds);
  }
  return f;
}

}  // namespace palpate::verify
