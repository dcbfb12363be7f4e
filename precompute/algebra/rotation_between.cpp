// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/algebra/rotation_between.hpp"

namespace palpate::algebra {

Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized(), b = to.normalized();
  const double twice_squared = 1 + a.dot(b);  // of the cosine of half the angle
  if (twice_squared < 1e-12) {
    const Eigen::Vector3d axis = a.unitOrthogonal();
    return {0, axis.x(), axis.y(), axis.z()};
  }
  const Eigen::Vector3d axis = a.cross(b);
  return Eigen::Quaterniond(twice_squared, axis.x(), axis.y(), axis.z()).normalized();
}

}  // namespace palpate::algebra
