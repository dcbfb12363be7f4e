// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/solver_bench.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>

namespace palpate::verify {
namespace {

PairResult solve(const Scene& scene, const Body& body, const tool::Tool& tool, const BenchContact& contact,
                 const MeshSetting& setting) {
  solve::PairOptions options = solve::pair_options(scene);
  solve::without_limits(options);  // a row has the cost of its own mesh alone, and its error against the reference
  options.mesh_size = setting.mesh_size;
  options.growth = setting.growth;
  if (setting.max_size > 0) options.max_size = setting.max_size * body.diagonal;
  return solve::solve_pair({body, tool, tool.vertices.at(0), contact.frame}, solve::bake_path(scene, contact.depth),
                           options);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Up to now.
double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

// Medians over the contacts that both solved.
void compare(const std::vector<PairResult>& solved, const std::vector<PairResult>& references, SolverBenchRow& row) {
  std::vector<double> normal, tangential, stiffness;
  for (std::size_t k = 0; k < solved.size(); ++k) {
    if (!solved[k].outcome.accepted || !references[k].outcome.accepted) {
      ++row.refused;
      continue;
    }
    ++row.solved;
    const solve::SampleDifference d = solve::sample_difference(solved[k].samples, references[k].samples);
    normal.push_back(d.normal);
    tangential.push_back(d.tangential);
    stiffness.push_back(d.stiffness);
  }
  row.difference.normal = median(normal);
  row.difference.tangential = median(tangential);
  row.difference.stiffness = median(stiffness);
}

}  // namespace

std::vector<SolverBenchRow> bench_solver(const Scene& scene, const Body& body, const tool::Tool& tool,
                                         const std::vector<BenchContact>& contacts, const SolverBenchOptions& options) {
  std::vector<SolverBenchRow> rows;
  std::vector<std::vector<PairResult>> solved;
  for (const MeshSetting& setting : options.settings) {
    SolverBenchRow row;
    row.setting = setting;
    solved.emplace_back();
    std::size_t accepted = 0;
    for (const BenchContact& contact : contacts) {
      PairResult result;
      std::vector<double> seconds;
      for (int k = 0; k < options.repeats; ++k) {
        const auto start = std::chrono::steady_clock::now();
        result = solve(scene, body, tool, contact, setting);
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      }
      if (result.outcome.accepted) {
        ++accepted;
        row.seconds += median(seconds);
        row.nodes += result.outcome.nodes;
      }
      solved.back().push_back(std::move(result));
    }
    if (accepted > 0) {
      row.seconds /= double(accepted);
      row.nodes /= double(accepted);
    }
    row.megabytes = peak_megabytes();
    rows.push_back(row);
  }
  std::vector<PairResult> references;
  for (const BenchContact& contact : contacts) {
    references.push_back(solve(scene, body, tool, contact, options.reference));
  }
  for (std::size_t k = 0; k < rows.size(); ++k) compare(solved[k], references, rows[k]);
  return rows;
}

}  // namespace palpate::verify
