// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/laws/friction_limit.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "precompute/solve/pair/solved_limit.hpp"

namespace palpate::fit {
namespace {

// Pushes of one path reach equally far, less the elastic slip.
constexpr double kFurthest = 0.9;

struct Sum {
  double total = 0.0;
  int count = 0;
  [[nodiscard]] double mean() const { return total / count; }
};

// Normal samples by their depth.
std::map<double, const Sample*> normal_pushes(const std::vector<Sample>& samples) {
  std::map<double, const Sample*> all;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::normal) all[s.deflection.z()] = &s;
  }
  return all;
}

using Points = std::vector<std::pair<double, double>>;

Points::const_iterator first_above(const Points& points, double at) {
  return std::upper_bound(points.begin(), points.end(), at,
                          [](double z, const auto& point) { return z < point.first; });
}

double interpolate(const Points& points, double at) {
  const auto above = first_above(points, at);
  if (above == points.begin()) return points.front().second;
  if (above == points.end()) return points.back().second;
  const auto below = above - 1;
  return std::lerp(below->second, above->second, (at - below->first) / (above->first - below->first));
}

// Solved over predicted by depth, for pushes that slip as a whole or (`in_part`) for depths where none does. A slipping
// push has the depth of its normal push, bit by bit. Only the farthest pushes of a depth count, because tissue still
// piles up before a tool that has just begun to slide.
Points ratios(const std::vector<Sample>& samples, double scale, bool in_part) {
  std::map<double, double> furthest;
  std::set<double> whole;  // depths at which some push did
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::slipping && s.friction_limit > 0) whole.insert(s.deflection.z());
  }
  const auto counts = [&](const Sample& s) {
    return s.kind == SampleKind::slipping && (in_part ? whole.count(s.deflection.z()) == 0 : s.friction_limit > 0);
  };
  for (const Sample& s : samples) {
    if (!counts(s)) continue;
    double& reach = furthest[s.deflection.z()];
    reach = std::max(reach, s.deflection.head<2>().norm());
  }
  const std::map<double, const Sample*> normal = normal_pushes(samples);
  std::map<double, Sum> solved;
  for (const Sample& s : samples) {
    if (!counts(s) || s.deflection.head<2>().norm() < kFurthest * furthest[s.deflection.z()]) continue;
    const auto from = normal.find(s.deflection.z());
    if (from == normal.end()) continue;
    Sum& sum = solved[s.deflection.z()];
    sum.total += solve::solved_limit(s, *from->second, scale);
    ++sum.count;
  }
  Points all;
  for (const auto& [depth, sum] : solved) {
    const double predicted = normal.at(depth)->friction_limit;
    if (predicted > 0) all.emplace_back(depth, sum.mean() / predicted);
  }
  return all;
}

// From depth 0 on, ascending.
Points corrections(const std::vector<Sample>& samples, double scale) {
  Points all{{0.0, 1.0}};
  const Points whole = ratios(samples, scale, false);
  all.insert(all.end(), whole.begin(), whole.end());
  for (const auto& [depth, least] : ratios(samples, scale, true)) {
    if (least > interpolate(all, depth)) all.insert(first_above(all, depth), {depth, least});
  }
  return all;
}

}  // namespace

std::vector<std::pair<double, double>> friction_limits(const std::vector<Sample>& samples, double depth_scale) {
  const Points ratio = corrections(samples, depth_scale);
  std::vector<std::pair<double, double>> limits;
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::normal) continue;
    const double depth = s.deflection.z();
    limits.emplace_back(depth, s.friction_limit * interpolate(ratio, depth));
  }
  return limits;
}

}  // namespace palpate::fit
