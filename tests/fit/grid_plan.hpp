// SPDX-License-Identifier: GPL-3.0-or-later
// A plan over a flat grid of sites and a journal content with analytic pairs, without any solve.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "formats/journal/journal.hpp"
#include "precompute/bake/plan.hpp"
#include "tests/fit/analytic_pair.hpp"

namespace palpate::test {

struct GridPlan {
  bake::Plan plan;
  std::vector<std::array<std::int32_t, 3>> triangles;
  JournalContent journal;
};

/// n x n sites 1 cm apart in the plane z = 0, one tool vertex, all pairs planned and accepted. Tangent frames turn
/// by `spin` (rad) from site to site; `pair_at` gives the answer in WORLD axes (z is the normal).
inline GridPlan grid_plan(int n, double depth, double spin, const std::function<AnalyticPair(int)>& pair_at) {
  GridPlan grid;
  for (int k = 0; k < n * n; ++k) {
    bake::PlanSite site;
    const double angle = spin * k;
    site.frame.origin = {0.01 * (k % n), 0.01 * (k / n), 0};
    site.frame.x = {std::cos(angle), std::sin(angle), 0};
    site.frame.y = {-std::sin(angle), std::cos(angle), 0};
    site.depth = depth;
    site.area = 1e-4;
    grid.plan.sites.push_back(site);
    PairPlan pair;
    pair.site = static_cast<std::uint32_t>(k);
    pair.frame = site.frame;
    pair.depth = depth;
    grid.plan.pairs.push_back(pair);

    JournalPair& solved = grid.journal.pairs[pair.site];
    const AnalyticPair truth = pair_at(k);
    solved.samples = samples_of(truth, depth);
    for (Sample& s : solved.samples) {
      s.force = site.frame.to_local(truth.force(site.frame.to_world(s.deflection)));
    }
    solved.outcome.emplace();
    solved.outcome->accepted = true;
  }
  for (int y = 0; y + 1 < n; ++y) {
    for (int x = 0; x + 1 < n; ++x) {
      const int a = y * n + x;
      grid.triangles.push_back({a, a + 1, a + n});
      grid.triangles.push_back({a + 1, a + n + 1, a + n});
    }
  }
  return grid;
}

inline void refuse(GridPlan& grid, std::uint32_t pair, const std::string& cause) {
  grid.journal.pairs[pair].samples.clear();
  grid.journal.pairs[pair].outcome->accepted = false;
  grid.journal.pairs[pair].outcome->cause = cause;
}

/// Takes a site's pair out of the plan, as a support does.
inline void skip(GridPlan& grid, std::uint32_t site, bake::SkipReason reason) {
  JournalContent journal;
  std::vector<PairPlan> pairs;
  for (std::uint32_t k = 0; k < grid.plan.pairs.size(); ++k) {
    if (grid.plan.pairs[k].site == site) continue;
    journal.pairs[static_cast<std::uint32_t>(pairs.size())] = grid.journal.pairs[k];
    pairs.push_back(grid.plan.pairs[k]);
  }
  grid.plan.pairs = std::move(pairs);
  grid.journal = std::move(journal);
  grid.plan.skipped.push_back({site, 0, 0, reason});
}

}  // namespace palpate::test
