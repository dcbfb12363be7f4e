// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "precompute/verify/battery/battery_cell.hpp"

#include <algorithm>
#include <limits>

namespace palpate::test {

/// Extent of a cell's body along z (m): the thickness of a block on its support.
inline double thickness(const verify::BatteryCell& cell) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Eigen::Vector3d& v : cell.surface.vertices) low = std::min(low, v.z()), high = std::max(high, v.z());
  return high - low;
}

}  // namespace palpate::test
