// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/battery/battery.hpp"

#include "formats/io/error.hpp"
#include "precompute/common/draw.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "precompute/solve/pair/sample_difference.hpp"
#include "precompute/verify/parallel.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <map>
#include <mutex>
#include <new>

namespace palpate {
namespace {

using Eigen::Vector3d;
using End = CellResult::End;

PairResult solve(const StiffCell& cell, const Body& body, double refine,
                 ContactMethod method = ContactMethod::penalty) {
  const Tool tool = make_tool(cell.scene.tools.at(0));
  ContactFrame frame;
  frame.origin = body.query->closest(cell.site).point;
  frame.n = cell.normal;
  frame.x = frame.n.unitOrthogonal();
  frame.y = frame.n.cross(frame.x);
  PairOptions options = pair_options(cell.scene);
  options.method = method;
  if (refine < 1) options = finer_options(options, body, refine);
  return solve_pair(body, tool, tool.vertices.at(0), frame, bake_path(cell.scene, cell.depth), options);
}

bool finite(const std::vector<Sample>& samples) {
  return std::all_of(samples.begin(), samples.end(),
                     [](const Sample& s) { return s.force.allFinite() && s.deflection.allFinite(); });
}

// A refusal is what a cell is; a missing worker or no memory left is the machine's fault, and ends the battery.
void rethrow_if_unsound() {
  try {
    throw;
  } catch (const Error& error) {
    if (error.code() == ExitCode::io) throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (...) {
  }
}

CellResult run(const StiffCell& cell) {
  CellResult result;
  const auto start = std::chrono::steady_clock::now();
  try {
    PairResult solved = solve(cell, prepare_body(cell.scene, cell.surface), 1.0);
    result.nodes = solved.outcome.nodes;
    result.cause = solved.outcome.cause;
    if (solved.outcome.accepted && finite(solved.samples)) {
      result.end = End::converged;
      result.samples = std::move(solved.samples);
    } else if (solved.outcome.accepted) {
      result.cause = "a force or a deflection is not finite";
    }
  } catch (const std::exception& error) {
    rethrow_if_unsound();
    result.cause = error.what();
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

void compare(CellResult& result, const PairResult& other) {
  result.check_cause = other.outcome.cause;
  if (!other.outcome.accepted) return;
  const SampleDifference d = sample_difference(result.samples, other.samples);
  if (d.compared == 0) {
    result.check_cause = "no sample of the check matches";
    return;
  }
  result.difference = std::max(d.straight, d.sideways);
  result.compared = d.compared;
  result.foretold = d.foretold;
  result.check_cause.clear();
}

// Elements at most 0.6 times as large; a cell that converged on a finer rung of the ladder needs smaller ones still.
void check(const StiffCell& cell, CellResult& result) {
  constexpr double kMoreNodes = 1.3;
  try {
    const Body body = prepare_body(cell.scene, cell.surface);
    for (const double refine : {0.6, 0.36}) {
      const PairResult fine = solve(cell, body, refine);
      if (fine.outcome.accepted && fine.outcome.nodes < kMoreNodes * result.nodes) {
        result.check_cause = "the check's mesh is hardly finer";
        continue;
      }
      compare(result, fine);
      break;
    }
    if (result.difference) return;
    const std::string finer = result.check_cause;
    compare(result, solve(cell, body, 1.0, ContactMethod::augmented));
    result.augmented = result.difference.has_value();
    result.check_cause = result.augmented ? finer : finer + "; augmented Lagrange: " + result.check_cause;
  } catch (const std::exception& error) {
    rethrow_if_unsound();
    result.check_cause = error.what();
  }
}

// A share of the converged cells of every family, at least one. A cell that cannot be checked is reported, and another
// cell drawn in its place as long as there are any.
class Draws {
public:
  Draws(const std::vector<StiffCell>& cells, const BatteryResult& result, const BatteryOptions& options) {
    std::map<std::string, std::vector<std::size_t>> converged;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      if (result.cells[k].end == End::converged) converged[cells[k].family].push_back(k);
    }
    for (const auto& [family, numbers] : converged) {
      Family drawn;
      drawn.wanted = draw_share(numbers.size(), options.verified_share, options.seed).size();
      for (const std::size_t k : draw_share(numbers.size(), 1.0, options.seed)) drawn.order.push_back(numbers[k]);
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

BatteryResult run_battery(const std::vector<StiffCell>& cells, const BatteryOptions& options) {
  BatteryResult result;
  result.cells.resize(cells.size());
  std::size_t done = 0;
  std::mutex guard;
  const auto report = [&](std::size_t total) {
    const std::lock_guard lock(guard);
    ++done;
    if (options.progress) options.progress(done, total);
  };
  result.stopped = !parallel_for(cells.size(), options.threads, options.stop, [&](std::size_t k) {
    result.cells[k] = run(cells[k]);
    report(cells.size());
  });
  if (result.stopped) return result;
  Draws draws(cells, result, options);
  std::size_t total = cells.size();
  for (auto drawn = draws.next(result); !drawn.empty() && !result.stopped; drawn = draws.next(result)) {
    total += drawn.size();
    result.stopped = !parallel_for(drawn.size(), options.threads, options.stop, [&](std::size_t k) {
      check(cells[drawn[k]], result.cells[drawn[k]]);
      report(total);
    });
  }
  return result;
}

BatteryFigures battery_figures(const std::vector<StiffCell>& cells, const BatteryResult& result, double tolerance,
                               const std::string& family) {
  BatteryFigures f;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (!family.empty() && cells[k].family != family) continue;
    const CellResult& cell = result.cells[k];
    const bool converged = cell.end == End::converged;
    ++f.cells;
    f.converged += converged;
    f.core += cells[k].core;
    f.core_converged += cells[k].core && converged;
    f.unchecked += !cell.difference && !cell.check_cause.empty();
    f.verified += cell.difference && *cell.difference <= tolerance;
    f.augmented += cell.augmented;
    f.compared += cell.compared;
    f.foretold += cell.foretold;
    f.wrong += cell.difference && !(*cell.difference <= tolerance);
    f.slowest = std::max(f.slowest, cell.seconds);
  }
  return f;
}

}  // namespace palpate
