// SPDX-License-Identifier: GPL-3.0-or-later
// The six shape functions of a face (node order as in tet_mesh.hpp) at barycentric coordinates a, b, c = 1 - a - b.
#pragma once

#include <Eigen/Core>
#include <array>

namespace palpate::fem {

inline std::array<double, 6> face_values(double a, double b) {
  const double c = 1 - a - b;
  return {a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a};
}

/// Their derivatives by a and b.
inline Eigen::Matrix<double, 6, 2> face_gradients(double a, double b) {
  const double c = 1 - a - b;
  Eigen::Matrix<double, 6, 2> d;
  d << 4 * a - 1, 0, 0, 4 * b - 1, 1 - 4 * c, 1 - 4 * c, 4 * b, 4 * a, -4 * b, 4 * (c - b), 4 * (c - a), -4 * a;
  return d;
}

}  // namespace palpate::fem
