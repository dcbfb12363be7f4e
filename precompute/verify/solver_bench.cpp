// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/solver_bench.hpp"

#include <algorithm>
#include <chrono>

namespace palpate {
namespace {

PairResult solve(const Scene& scene, const Body& body, const Tool& tool, const BenchContact& contact,
                 const MeshSetting& setting) {
  PairOptions options = pair_options(scene);
  options.mesh_size = setting.mesh_size;
  options.growth = setting.growth;
  if (setting.max_size > 0) options.max_size = setting.max_size * body.diagonal;
  return solve_pair(body, tool, tool.vertices.at(0), contact.frame, bake_path(scene, contact.depth), options);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<SolverBenchRow> bench_solver(const Scene& scene, const Body& body, const Tool& tool,
                                         const std::vector<BenchContact>& contacts, const SolverBenchOptions& options) {
  const auto stopped = [&] { return options.stop && options.stop(); };
  std::vector<PairResult> references;
  for (const BenchContact& contact : contacts) {
    if (stopped()) return {};
    references.push_back(solve(scene, body, tool, contact, options.reference));
  }
  std::vector<SolverBenchRow> rows;
  for (const MeshSetting& setting : options.settings) {
    SolverBenchRow row;
    row.setting = setting;
    std::vector<double> straight, sideways, stiffness;
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      if (stopped()) return rows;
      const auto start = std::chrono::steady_clock::now();
      const PairResult result = solve(scene, body, tool, contacts[k], setting);
      if (!result.outcome.accepted || !references[k].outcome.accepted) {
        ++row.refused;
        continue;
      }
      ++row.solved;
      row.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      row.nodes += result.outcome.nodes;
      const SampleDifference d = sample_difference(result.samples, references[k].samples);
      straight.push_back(d.straight);
      sideways.push_back(d.sideways);
      stiffness.push_back(d.stiffness);
    }
    if (row.solved > 0) {
      row.seconds /= double(row.solved);
      row.nodes /= double(row.solved);
    }
    row.difference.straight = median(straight);
    row.difference.sideways = median(sideways);
    row.difference.stiffness = median(stiffness);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace palpate
