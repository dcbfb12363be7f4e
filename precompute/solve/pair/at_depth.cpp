// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/pair/at_depth.hpp"

#include <cmath>

namespace palpate::solve {

std::optional<Eigen::Vector3d> at_depth(const std::function<double(const Eigen::Vector3d&)>& gap,
                                        Eigen::Vector3d translation, const Eigen::Vector3d& normal, double depth,
                                        double resolution, double reach) {
  double shift = 0.0;
  for (int k = 0; k < 100; ++k) {
    const double off = gap(translation + shift * normal);
    if (std::abs(off) <= resolution) return translation + (shift - depth) * normal;
    shift -= off;
    if (!(std::abs(shift) <= reach)) break;
  }
  return std::nullopt;
}

}  // namespace palpate::solve
