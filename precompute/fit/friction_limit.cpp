// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/friction_limit.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace palpate::fit {
namespace {

// Pushes of one path reach alike, less what the elastic slip gives.
constexpr double kFurthest = 0.9;

struct Sum {
  double total = 0.0;
  int count = 0;
  [[nodiscard]] double mean() const { return total / count; }
};

// Straight pushes by their depth.
std::map<double, const Sample*> straight_pushes(const std::vector<Sample>& samples) {
  std::map<double, const Sample*> all;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::normal) all[s.deflection.z()] = &s;
  }
  return all;
}

// Solved over foretold by depth. A slipping push has the depth of the straight one that it began from, bit by bit.
// Tissue still piles up before a tool that has just begun to slide: of a depth's pushes only what was drawn furthest
// counts.
std::vector<std::pair<double, double>> corrections(const std::vector<Sample>& samples) {
  std::map<double, double> furthest;
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::slipping || !(s.friction_limit > 0)) continue;
    double& reach = furthest[s.deflection.z()];
    reach = std::max(reach, s.deflection.head<2>().norm());
  }
  const std::map<double, const Sample*> straight = straight_pushes(samples);
  std::map<double, Sum> solved;
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::slipping || !(s.friction_limit > 0)) continue;
    if (s.deflection.head<2>().norm() < kFurthest * furthest[s.deflection.z()]) continue;
    const auto from = straight.find(s.deflection.z());
    if (from == straight.end()) continue;
    Sum& sum = solved[s.deflection.z()];
    sum.total += solved_limit(s, *from->second);
    ++sum.count;
  }
  std::vector<std::pair<double, double>> all{{0.0, 1.0}};
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::normal || !(s.friction_limit > 0)) continue;
    const auto at = solved.find(s.deflection.z());
    if (at != solved.end()) all.emplace_back(at->first, at->second.mean() / s.friction_limit);
  }
  std::sort(all.begin(), all.end());
  return all;
}

double interpolate(const std::vector<std::pair<double, double>>& points, double at) {
  const auto above =
      std::upper_bound(points.begin(), points.end(), at, [](double z, const auto& point) { return z < point.first; });
  if (above == points.begin()) return points.front().second;
  if (above == points.end()) return points.back().second;
  const auto below = above - 1;
  return std::lerp(below->second, above->second, (at - below->first) / (above->first - below->first));
}

}  // namespace

std::vector<std::pair<double, double>> friction_limits(const std::vector<Sample>& samples) {
  const std::vector<std::pair<double, double>> ratio = corrections(samples);
  std::vector<std::pair<double, double>> limits;
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::normal) continue;
    limits.emplace_back(s.deflection.z(), s.friction_limit * interpolate(ratio, s.deflection.z()));
  }
  return limits;
}

}  // namespace palpate::fit
