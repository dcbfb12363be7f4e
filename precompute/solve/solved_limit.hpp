// SPDX-License-Identifier: GPL-3.0-or-later
// The friction limit that a solved contact shows where it slips.
#pragma once

#include "formats/samples.hpp"
#include "palpate/format/response_layout.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

/// mu(depth) as a contact that slips everywhere tells it: what friction holds, over the normal force that it has then.
/// It holds it about as much of the straight push's sideways force (in proportion to the normal force) as is how the
/// tissue lies against the tool (layout::kFlanks). `depth_scale`: Z (m).
inline double solved_limit(const Sample& slipping, const Sample& straight, double depth_scale) {
  const double root = std::sqrt(std::min(straight.deflection.z() / depth_scale, 1.0));
  const auto sideways = [](const Sample& s) { return Eigen::Vector2d(s.force.head<2>() / s.force.z()); };
  return (sideways(slipping) - layout::kFlanks * root * sideways(straight)).norm();
}

}  // namespace palpate
