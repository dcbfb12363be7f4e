// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/battery.hpp"

#include "precompute/solve/pair.hpp"
#include "precompute/verify/parallel.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <map>
#include <mutex>
#include <random>

namespace palpate {
namespace {

using Eigen::Vector3d;
using End = CellResult::End;

PairResult solve(const StiffCell& cell, const Body& body, bool finer) {
  const Tool tool = make_tool(cell.scene.tools.at(0));
  ContactFrame frame;
  frame.origin = body.query->closest(cell.site).point;
  frame.n = cell.normal;
  frame.x = frame.n.unitOrthogonal();
  frame.y = frame.n.cross(frame.x);
  PairOptions options = pair_options(cell.scene);
  if (finer) {
    options.mesh_size *= 0.6;
    options.growth *= 0.7;
    options.max_size = body.diagonal / 12;
  }
  return solve_pair(body, tool, tool.vertices.at(0), frame, bake_path(cell.scene, cell.depth), options);
}

bool finite(const std::vector<Sample>& samples) {
  return std::all_of(samples.begin(), samples.end(),
                     [](const Sample& s) { return s.force.allFinite() && s.deflection.allFinite(); });
}

// Straight pushes, the deepest first: of shallow points one of two curves may have fewer.
std::vector<const Sample*> straight(const std::vector<Sample>& samples) {
  std::vector<const Sample*> all;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::normal) all.push_back(&s);
  }
  std::reverse(all.begin(), all.end());
  return all;
}

// Largest relative difference over the deeper half of the straight push and over the sideways ones.
double difference(const std::vector<Sample>& coarse, const std::vector<Sample>& fine) {
  double worst = 0.0;
  const auto compare = [&](const Sample& a, const Sample& b) {
    worst = std::max(worst, (a.force - b.force).norm() / b.force.norm());
  };
  const auto a = straight(coarse), b = straight(fine);
  for (std::size_t k = 0; 2 * k < std::min(a.size(), b.size()); ++k) compare(*a[k], *b[k]);
  for (const Sample& s : coarse) {
    for (const Sample& other : fine) {
      const bool same = s.kind == SampleKind::tangential && other.kind == s.kind && other.index == s.index;
      if (same) compare(s, other);
    }
  }
  return worst;
}

CellResult run(const StiffCell& cell) {
  CellResult result;
  const auto start = std::chrono::steady_clock::now();
  try {
    PairResult solved = solve(cell, prepare_body(cell.scene, cell.surface), false);
    result.nodes = solved.outcome.nodes;
    result.cause = solved.outcome.cause;
    if (solved.outcome.accepted && finite(solved.samples)) {
      result.end = End::converged;
      result.samples = std::move(solved.samples);
    } else if (solved.outcome.accepted) {
      result.cause = "a force or a deflection is not finite";
    }
  } catch (const std::exception& error) {
    result.cause = error.what();
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

void check(const StiffCell& cell, CellResult& result) {
  const PairResult fine = solve(cell, prepare_body(cell.scene, cell.surface), true);
  if (fine.outcome.accepted) {
    result.difference = difference(result.samples, fine.samples);
  } else {
    result.check_cause = fine.outcome.cause;
  }
}

// A share of the converged cells of every family, at least one.
std::vector<std::size_t> draw(const std::vector<StiffCell>& cells, const BatteryResult& result,
                              const BatteryOptions& options) {
  std::map<std::string, std::vector<std::size_t>> families;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (result.cells[k].end == End::converged) families[cells[k].family].push_back(k);
  }
  std::mt19937_64 engine(options.seed);
  std::vector<std::size_t> drawn;
  for (auto& [family, numbers] : families) {
    for (std::size_t k = numbers.size(); k > 1; --k) std::swap(numbers[k - 1], numbers[engine() % k]);
    const auto count = std::size_t(std::ceil(options.verified_share * double(numbers.size())));
    drawn.insert(drawn.end(), numbers.begin(), numbers.begin() + std::ptrdiff_t(std::min(count, numbers.size())));
  }
  return drawn;
}

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
  const std::vector<std::size_t> drawn = draw(cells, result, options);
  result.stopped = !parallel_for(drawn.size(), options.threads, options.stop, [&](std::size_t k) {
    check(cells[drawn[k]], result.cells[drawn[k]]);
    report(cells.size() + drawn.size());
  });
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
    f.verified += cell.difference && *cell.difference <= tolerance;
    f.wrong += cell.difference && !(*cell.difference <= tolerance);
    f.slowest = std::max(f.slowest, cell.seconds);
  }
  return f;
}

}  // namespace palpate
