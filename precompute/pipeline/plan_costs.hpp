// SPDX-License-Identifier: GPL-3.0-or-later
// Costs of a plan, from timed pairs of each role.
#pragma once

#include <array>
#include <cstddef>

#include "precompute/pipeline/pipeline.hpp"

namespace palpate::pipeline {

/// By PairRole.
struct RoleCost {
  std::size_t pairs = 0;  ///< planned
  std::size_t open = 0;   ///< of these without an outcome
  double seconds = 0.0;   ///< of a processor for one pair: normal for hidden ones, too
};

struct PlanCosts {
  std::array<RoleCost, 3> roles;
  double processor_seconds = 0.0;  ///< of all open pairs of this round
  double peak_bytes = 0.0;         ///< of memory: this process and its largest child, after the timed pairs
  double file_bytes = 0.0;         ///< of the response file with the sites of this round
};

/// Solves a quarter of the pairs of each role, 2 to 16 of them, evenly spaced in the plan (nothing is kept), on as many
/// `threads` as will bake, because threads that share a core are slower, and multiplies. Needs plan().
PlanCosts cost_plan(const Pipeline& pipeline, unsigned threads);

}  // namespace palpate::pipeline
