// SPDX-License-Identifier: GPL-3.0-or-later
// det F and its derivatives, with matrices stacked by columns (law.hpp).
#pragma once

#include "precompute/fem/materials/law.hpp"

#include <Eigen/Geometry>

namespace palpate::fem {

inline Eigen::Matrix<double, 9, 1> stacked(const Eigen::Matrix3d& m) {
  return Eigen::Map<const Eigen::Matrix<double, 9, 1>>(m.data());
}

/// d det F / dF.
inline Eigen::Matrix3d cofactor(const Eigen::Matrix3d& f) {
  Eigen::Matrix3d c;
  c.col(0) = f.col(1).cross(f.col(2));
  c.col(1) = f.col(2).cross(f.col(0));
  c.col(2) = f.col(0).cross(f.col(1));
  return c;
}

/// Adds `scale` times the second derivative of det F, which is linear in F: the cross products of its columns.
inline void add_curvature_of_j(const Eigen::Matrix3d& f, double scale, Tangent& t) {
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, n = (a + 2) % 3;
    const Eigen::Vector3d v = scale * f.col(n);
    Eigen::Matrix3d cross;  // cross(i, k) = epsilon_ikm v_m
    cross << 0, v.z(), -v.y(), -v.z(), 0, v.x(), v.y(), -v.x(), 0;
    t.block<3, 3>(3 * a, 3 * b) += cross;
    t.block<3, 3>(3 * b, 3 * a) += cross.transpose();
  }
}

}  // namespace palpate::fem
