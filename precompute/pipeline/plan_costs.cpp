// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/pipeline/plan_costs.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <vector>

#include "palpate/format/response_layout.hpp"
#include "precompute/bake/parallel.hpp"

namespace palpate::pipeline {
namespace {

constexpr double kResponseBytes = 64;  // of 24 coefficients of 16 bits with their head
constexpr double kProvenance = 4096;
// Pairs of a role that are timed: a quarter of them, within these limits. One in ten takes several times as long as the
// others.
constexpr std::size_t kLeastTimed = 2, kMostTimed = 16;

/// Processor time of this process and of the children that it waited for.
double processor_seconds() {
  double seconds = 0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    ::getrusage(who, &usage);
    for (const timeval& t : {usage.ru_utime, usage.ru_stime}) {
      seconds += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    }
  }
  return seconds;
}

double peak_bytes() {
  double kilobytes = 0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    ::getrusage(who, &usage);
    kilobytes += static_cast<double>(usage.ru_maxrss);
  }
  return 1024 * kilobytes;
}

double file_bytes(const Pipeline& p) {
  const mesh::ContactSurface contact = contact_surface(p);
  std::size_t vertices = 0;
  for (const tool::Tool& tool : p.tools) vertices += tool.vertices.size();
  return kProvenance +
         static_cast<double>(p.mesh.points.size()) *
             (sizeof(layout::Site) + kResponseBytes * static_cast<double>(vertices)) +
         static_cast<double>(contact.points.size()) * sizeof(layout::Point) +
         static_cast<double>(contact.triangles.size()) * layout::triangle_size(2) +
         static_cast<double>(contact.patches.size()) * layout::patch_size(2);
}

}  // namespace

PlanCosts cost_plan(const Pipeline& p, unsigned threads) {
  JournalContent journal;
  if (std::filesystem::exists(p.paths.journal)) journal = read_journal(p.paths.journal, p.manifest);
  PlanCosts costs;
  std::array<std::vector<std::uint32_t>, 3> pairs;
  for (std::uint32_t pair = 0; pair < p.plan.pairs.size(); ++pair) {
    if (!p.sources.solved(pair)) continue;
    const auto role = static_cast<std::size_t>(p.plan.pairs[pair].role);
    pairs[role].push_back(pair);
    ++costs.roles[role].pairs;
    const auto at = journal.pairs.find(pair);
    if (at == journal.pairs.end() || !at->second.outcome) ++costs.roles[role].open;
  }
  const bake::PairSolver solver = contact_solver(p);
  for (std::size_t role = 0; role < pairs.size(); ++role) {
    if (pairs[role].empty()) continue;
    const std::size_t timed = std::min(std::clamp(pairs[role].size() / 4, kLeastTimed, kMostTimed), pairs[role].size());
    const double before = processor_seconds();
    bake::parallel_for(timed, threads, {}, [&](std::size_t k) {
      solver(p.plan.pairs[pairs[role][(2 * k + 1) * pairs[role].size() / (2 * timed)]], {});
    });
    costs.roles[role].seconds = (processor_seconds() - before) / static_cast<double>(timed);
  }
  for (const RoleCost& role : costs.roles) costs.processor_seconds += static_cast<double>(role.open) * role.seconds;
  costs.peak_bytes = peak_bytes();
  costs.file_bytes = file_bytes(p);
  return costs;
}

}  // namespace palpate::pipeline
