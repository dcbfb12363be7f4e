// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/battery/random_battery.hpp"

#include "precompute/bake/parallel.hpp"
#include "precompute/solve/pair/sample_difference.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

namespace palpate::verify {
namespace {

// An error below is the solver's tolerance on both meshes: a ratio to it says nothing.
constexpr double kSmallestError = 1e-3;

constexpr double kReferenceLimit = 200;  // s of processor time of the finer mesh; beyond it a cell stays open

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) { return values[std::size_t(share * double(values.size() - 1) + 0.5)]; };
  return {at(0.5), at(0.95), values.back()};
}

// The contact that is judged on a much finer mesh; its longest elements are refined by the root (contact_size). Without
// friction a force depends on the depth alone, and three depths are solved; with it all of the normal indentation is,
// and one of the tangential pushes.
void much_finer(solve::PairOptions& options, solve::PairPath& path, double refine) {
  solve::without_limits(options);
  options.time_limit = kReferenceLimit;
  options.refine *= refine;
  options.growth *= refine;
  std::vector<double>& depths = path.normal_depths;
  if (path.friction > 0) {
    path.tangential_depths.erase(path.tangential_depths.begin(), path.tangential_depths.end() - 1);
    path.tangential_directions = 1;
  } else {
    const std::size_t n = depths.size();
    depths = {depths[n / 3 - 1], depths[2 * n / 3 - 1], depths[n - 1]};
  }
}

}  // namespace

const char* verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::right:
      return "right";
    case Verdict::wrong:
      return "accepted and wrong";
    case Verdict::refused:
      return "refused by both meshes";
    case Verdict::refused_sound:
      return "refused though sound";
    case Verdict::open:
      break;
  }
  return "open";
}

JudgedCell judge_cell(const BatteryCell& cell, const RandomBatteryOptions& options) {
  CellSolve solve = solve_cell(cell);
  const CellSolve reference = solve_cell(cell, [&](solve::PairOptions& pair, solve::PairPath& path, const Body&) {
    much_finer(pair, path, options.refine);
  });
  return judge(std::move(solve), reference, options);
}

JudgedCell judge(CellSolve solve, const CellSolve& reference, const RandomBatteryOptions& options) {
  JudgedCell judged;
  judged.solve = std::move(solve);
  judged.reference = reference.samples;
  judged.reference_cause = reference.accepted ? "" : reference.cause;
  judged.reference_seconds = reference.processor;
  judged.reference_nodes = reference.nodes;
  if (!judged.solve.accepted) {
    judged.verdict = reference.accepted ? Verdict::refused_sound : Verdict::refused;
    return judged;
  }
  const solve::SampleDifference d = solve::sample_difference(judged.solve.samples, reference.samples);
  for (const solve::ComparedSample& s : d.samples) {
    const double estimate = judged.solve.samples[s.sample].error_estimate;
    judged.samples.push_back({s.difference, estimate});
    const double excess = s.difference / std::max(options.tolerance, options.estimates * estimate);
    if (!(excess <= judged.excess)) judged.excess = excess;
  }
  if (judged.samples.empty()) return judged;
  judged.verdict = judged.excess <= 1 ? Verdict::right : Verdict::wrong;
  return judged;
}

void run_random_battery(const std::vector<BatteryCell>& cells, const RandomBatteryOptions& options,
                        const std::function<void(std::size_t number, const JudgedCell& judged)>& done) {
  std::mutex guard;
  bake::parallel_for(cells.size(), options.threads, [&](std::size_t k) {
    const JudgedCell judged = judge_cell(cells[k], options);
    const std::lock_guard lock(guard);
    done(k, judged);
  });
}

RandomFigures random_figures(const std::vector<JudgedCell>& cells) {
  RandomFigures f;
  std::vector<double> errors, estimates, ratios, seconds, megabytes;
  for (const JudgedCell& cell : cells) {
    ++f.cells;
    ++f.verdicts[cell.verdict];
    seconds.push_back(cell.solve.processor);
    megabytes.push_back(cell.solve.megabytes);
    for (const JudgedSample& s : cell.samples) {
      ++f.samples;
      f.covered += s.error <= s.estimate;
      errors.push_back(s.error);
      estimates.push_back(s.estimate);
      ratios.push_back(s.estimate / std::max(s.error, kSmallestError));
    }
  }
  f.error = spread_of(std::move(errors));
  f.estimate = spread_of(std::move(estimates));
  f.ratio = spread_of(std::move(ratios));
  f.seconds = spread_of(std::move(seconds));
  f.megabytes = spread_of(std::move(megabytes));
  return f;
}

}  // namespace palpate::verify
