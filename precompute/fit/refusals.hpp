// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs that were refused, grouped by cause: responses that a file fills from neighbours, and why.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "precompute/bake/bake.hpp"
#include "precompute/bake/plan.hpp"

namespace palpate::fit {

/// Refused pairs whose causes differ in their figures alone.
struct Refusals {
  std::string example;      ///< the first pair with its cause
  std::size_t pairs = 0;    ///< how many there are
  double area_share = 0.0;  ///< [0, 1], of the body's area, mean over the tool vertices of the plan
};

/// Groups by cause, the most frequent first.
std::vector<Refusals> group_refusals(const bake::Plan& plan, const std::vector<bake::RefusedPair>& refused);

/// A line a group: "  3 (1.2 % of the area) like pair 17 (...): CAUSE", at most eight.
std::string to_text(const std::vector<Refusals>& refusals);

}  // namespace palpate::fit
