// SPDX-License-Identifier: GPL-3.0-or-later
// Eight quadratic tetrahedra side by side, one in each lane of wide registers.
#pragma once

#include "precompute/fem/materials/material.hpp"

#include <Eigen/Core>
#include <array>
#include <vector>

namespace palpate::fem {

/// Degree 2 of integration: exact for mu/2 (F:F - 3).
inline constexpr int kElementPoints = 4;

/// Barycentric coordinate of a point at the corner it belongs to, and at the three others (rule of degree 2).
inline constexpr double kNearCorner = 0.58541019662496845, kFarCorner = 0.13819660112501052;

/// Corners between which the nodes 4 to 9 lie.
inline constexpr std::array<std::array<int, 2>, 6> kElementEdges{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

struct ElementBatch {
  static constexpr int kLanes = 8;
  using Lanes [[gnu::vector_size(kLanes * sizeof(double)), gnu::aligned(kLanes * sizeof(double))]] = double;

  std::array<std::array<std::int32_t, kLanes>, 10> nodes;
  Lanes slopes[4][3];                          ///< gradients of the barycentric coordinates, 1/m
  Lanes volume;                                ///< m^3
  Lanes mu, bulk, local;                       ///< Pa, see Material
  Lanes slope;                                 ///< Pa; without laws less that of mu (J - 1), which goes with the other
                                               ///< terms of mu: the material's slope plus mu
  std::array<const Material*, kLanes> laws{};  ///< materials with laws to be evaluated at every point; null: none
  int count = 0;                               ///< lanes in use; what is in the others is finite and ignored
};

/// Energy (J) of the batches at the node positions x (3 N, m).
double batch_energy(const std::vector<ElementBatch>& batches, const Eigen::VectorXd& x);
/// Energy (J); adds its derivative (N) to `gradient` (3 N).
double batch_gradient(const std::vector<ElementBatch>& batches, const Eigen::VectorXd& x, Eigen::VectorXd& gradient);
/// Smallest det F at the quadrature points.
double batch_min_jacobian(const std::vector<ElementBatch>& batches, const Eigen::VectorXd& x);

}  // namespace palpate::fem
