// SPDX-License-Identifier: GPL-3.0-or-later
// Sorting along a line, then union of near neighbours on it.
#include "precompute/geometry/coincident.hpp"

#include "precompute/geometry/topology.hpp"

#include <algorithm>
#include <utility>

namespace palpate::geometry {

double sweep_place(const Eigen::Vector3d& point) { return point.dot(Eigen::Vector3d(0.5196, 0.6081, 0.6003)); }

std::vector<std::int32_t> coincident(const std::vector<Eigen::Vector3d>& points, double tolerance) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t v = 0; v < points.size(); ++v) order.emplace_back(sweep_place(points[v]), v);
  std::sort(order.begin(), order.end());
  Sets sets(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size() && order[j].first - order[i].first <= tolerance; ++j) {
      if ((points[order[i].second] - points[order[j].second]).norm() > tolerance) continue;
      sets.join(order[i].second, order[j].second);
    }
  }
  std::vector<std::int32_t> first;
  for (std::size_t v = 0; v < points.size(); ++v) first.push_back(std::int32_t(sets.find(v)));
  return first;
}

}  // namespace palpate::geometry
