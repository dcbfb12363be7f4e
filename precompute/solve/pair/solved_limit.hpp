// SPDX-License-Identifier: GPL-3.0-or-later
// The friction coefficient of a solved contact that slips.
#pragma once

#include "formats/journal/samples.hpp"
#include "palpate/format/response_coefficients.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::solve {

/// mu(depth) of a contact that slips everywhere: the tangential force that friction holds over the normal force. The part
/// of the tangential bias that remains while the contact slips (response::slipping_bias_share) is no friction.
/// `depth_scale`: Z (m).
inline double solved_limit(const Sample& slipping, const Sample& normal, double depth_scale) {
  const double root = std::sqrt(std::min(normal.deflection.z() / depth_scale, 1.0));
  const auto ratio = [](const Sample& s) { return Eigen::Vector2d(s.force.head<2>() / s.force.z()); };
  return (ratio(slipping) - response::slipping_bias_share(root) * ratio(normal)).norm();
}

}  // namespace palpate::solve
