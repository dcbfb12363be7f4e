// SPDX-License-Identifier: GPL-3.0-or-later
// A triangle in pieces, for what is sampled on a surface of any triangle size.
#pragma once

#include <Eigen/Core>

#include <algorithm>

namespace palpate::surface {

/// Calls use(a, b, c) for pieces of a triangle (m) that fill it, with edges of at most `longest` (m, > 0): the longest
/// edge is halved until it is short enough. The pieces keep the triangle's orientation.
template <class Use>
void for_each_piece(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, double longest,
                    const Use& use) {
  const Eigen::Vector3d* const corners[3] = {&a, &b, &c};
  const double edges[3] = {(b - a).norm(), (c - b).norm(), (a - c).norm()};
  const auto k = std::max_element(edges, edges + 3) - edges;
  if (edges[k] <= longest) return use(a, b, c);
  const Eigen::Vector3d &from = *corners[k], &to = *corners[(k + 1) % 3], &across = *corners[(k + 2) % 3];
  const Eigen::Vector3d middle = (from + to) / 2;
  for_each_piece(from, middle, across, longest, use);
  for_each_piece(middle, to, across, longest, use);
}

}  // namespace palpate::surface
