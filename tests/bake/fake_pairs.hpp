// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs with analytic answers, and a solver of them that takes a little while: a bake without contact solves.
#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "precompute/bake/bake.hpp"
#include "tests/fit/analytic_pair.hpp"

namespace palpate::test {

inline std::vector<PairPlan> fake_plan(std::uint32_t count) {
  std::vector<PairPlan> pairs(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    pairs[k].site = k;
    pairs[k].frame.origin = {0.01 * k, 0, 0};
    pairs[k].depth = 0.004 + 1e-5 * k;
  }
  return pairs;
}

struct FakeSolver {
  double friction = 0.3;
  std::chrono::microseconds per_sample{0};
  std::vector<std::uint32_t> refused_sites;
  mutable std::atomic<int> calls{0};

  PairResult operator()(const PairPlan& plan, const solve::SampleSink& sink) const {
    ++calls;
    AnalyticPair pair = power_law(400.0 + 3.0 * plan.site, 1.5);
    pair.friction = friction;
    pair.growth = [](double z) { return std::sqrt(z / 0.005); };
    pair.tangential_x = [](double x) { return -70 * x; };
    pair.tangential_y = [](double y) { return -80 * y; };
    PairResult result;
    for (const std::uint32_t site : refused_sites) {
      if (site != plan.site) continue;
      result.outcome.cause = "penetration 0.4 of the contact radius at depth 2 mm, allowed 0.1";
      return result;
    }
    for (const Sample& sample : samples_of(pair, plan.depth)) {
      std::this_thread::sleep_for(per_sample);
      result.samples.push_back(sample);
      (sample.kind == SampleKind::normal ? result.outcome.normal_solves : result.outcome.tangential_solves) += 1;
      sink(sample);
    }
    result.outcome.accepted = true;
    result.outcome.nodes = 1000 + plan.site;
    return result;
  }
};

}  // namespace palpate::test
