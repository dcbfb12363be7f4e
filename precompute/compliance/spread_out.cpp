// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/compliance/spread_out.hpp"

#include <algorithm>
#include <limits>

namespace palpate::compliance {

std::vector<std::size_t> spread_out(const std::vector<LoadSite>& sites, const std::vector<char>& usable) {
  std::vector<std::size_t> left, order;
  for (std::size_t s = 0; s < sites.size(); ++s) {
    if (usable[s]) left.push_back(s);
  }
  std::vector<double> distance(left.size(), std::numeric_limits<double>::infinity());
  for (std::size_t next = 0; order.size() < left.size();) {
    order.push_back(left[next]);
    distance[next] = -1;
    std::size_t furthest = 0;
    for (std::size_t k = 0; k < left.size(); ++k) {
      const double d = (sites[left[k]].point - sites[left[next]].point).norm();
      distance[k] = std::min(distance[k], d);
      if (distance[k] > distance[furthest]) furthest = k;
    }
    next = furthest;
  }
  return order;
}

}  // namespace palpate::compliance
