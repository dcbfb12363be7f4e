// SPDX-License-Identifier: GPL-3.0-or-later
// A thin capsule on the surface of a mesh: six-node membranes that share its nodes.
#pragma once

#include "precompute/fem/elastic.hpp"

#include <array>
#include <vector>

namespace palpate::fem {

struct MembraneOptions {
  double thickness = 0.0;  ///< m, unstrained; 0: no membrane
  double young = 0.0;      ///< Pa at small strain
};

/// Incompressible neo-Hookean sheet in plane stress: mu/2 (tr C + 1 / det C - 3) times the thickness, C the right
/// Cauchy-Green tensor in the surface (2 x 2), mu = young / 3. It has no stiffness against bending.
class MembraneEnergy {
public:
  /// On the outside of the mesh: walls of cavities have none, nor have faces whose six nodes are all `fixed`.
  MembraneEnergy(const mesh::TetMesh& mesh, const std::vector<char>& fixed, const MembraneOptions& options);

  /// Energy (J) at node positions x (3 N, m); infinite where a face has no area left.
  [[nodiscard]] double value(const Eigen::VectorXd& x) const;
  /// Energy (J); adds its derivative (N) to `gradient` (3 N).
  double gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const;
  /// Adds the second derivative (N/m); convex: without the part of compressive stresses.
  void hessian(const Eigen::VectorXd& x, HessianKind kind, BlockMatrix& matrix) const;

private:
  static constexpr int kPoints = 3;  // degree 2
  using Shape = Eigen::Matrix<double, 6, 2>;
  struct Face {
    std::array<std::int32_t, 6> nodes;
    std::array<Shape, kPoints> gradients;  // of the six shape functions in the face's plane, 1/m
    double weight = 0.0;                   // N/m: mu times thickness times area of a point
  };
  std::vector<Face> faces_;
};

}  // namespace palpate::fem
