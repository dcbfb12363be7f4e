// SPDX-License-Identifier: GPL-3.0-or-later
// As Eigen's Quaterniond::FromTwoVectors, whose decomposition for opposite directions costs a compiler 8 s.
#pragma once

#include <Eigen/Geometry>

namespace palpate::algebra {

/// The smallest rotation that takes one direction to another, of any length but zero; for opposite ones a half turn
/// about some axis.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace palpate::algebra
