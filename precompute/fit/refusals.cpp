// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/refusals.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>

namespace palpate::fit {
namespace {

constexpr std::size_t kShown = 8;

/// Body area times tool vertices (m^2).
double touched_area(const bake::Plan& plan) {
  double body = 0;
  for (const bake::PlanSite& site : plan.sites) body += site.area;
  std::set<std::pair<std::uint32_t, std::uint32_t>> vertices;
  for (const PairPlan& pair : plan.pairs) vertices.emplace(pair.tool, pair.tool_vertex);
  return body * static_cast<double>(vertices.size());
}

}  // namespace

std::vector<Refusals> group_refusals(const bake::Plan& plan, const std::vector<bake::RefusedPair>& refused) {
  const double area = touched_area(plan);
  std::map<std::string, Refusals> kinds;  // by the cause's text before its first figure
  for (const bake::RefusedPair& pair : refused) {
    Refusals& kind = kinds[pair.cause.substr(0, pair.cause.find_first_of("0123456789"))];
    if (++kind.pairs == 1) kind.example = bake::describe(pair.pair, plan.pairs[pair.pair]) + ": " + pair.cause;
    if (area > 0) kind.area_share += plan.sites[plan.pairs[pair.pair].site].area / area;
  }
  std::vector<Refusals> sorted;
  for (const auto& [text, kind] : kinds) sorted.push_back(kind);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Refusals& a, const Refusals& b) { return a.pairs > b.pairs; });
  return sorted;
}

std::string to_text(const std::vector<Refusals>& refusals) {
  std::string text;
  for (std::size_t k = 0; k < std::min(kShown, refusals.size()); ++k) {
    char count[80];
    std::snprintf(count, sizeof count, "  %zu (%.2g %% of the area) like ", refusals[k].pairs,
                  100 * refusals[k].area_share);
    text += count + refusals[k].example + "\n";
  }
  return text;
}

}  // namespace palpate::fit
