// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled once: for opposite directions Eigen falls back on a decomposition that costs a compiler 8 s.
#pragma once

#include <Eigen/Geometry>

namespace palpate {

/// The smallest rotation that takes one direction to another (Eigen's Quaterniond::FromTwoVectors). Neither may be
/// zero.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace palpate
