// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/algebra/rotation_between.hpp"

namespace palpate {

Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to);
}

}  // namespace palpate
