// SPDX-License-Identifier: GPL-3.0-or-later
// Which points of a list are at one place, found by a sweep along a line.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace palpate::geometry {

/// Place (m) along a line that no flat face of a real surface is square to: near points have near places on it.
double sweep_place(const Eigen::Vector3d& point);

/// Per point the lowest number among the points that it is connected to by steps of at most `tolerance`
/// (m, >= 0). No hashing: equal input gives equal numbers.
std::vector<std::int32_t> coincident(const std::vector<Eigen::Vector3d>& points, double tolerance);

}  // namespace palpate::geometry
