// SPDX-License-Identifier: GPL-3.0-or-later
// Weight of a body: the potential of gravity, linear in the displacement.
#pragma once

#include "precompute/mesh/tet_mesh.hpp"

#include <Eigen/Core>

namespace palpate::fem {

class WeightEnergy {
public:
  /// `force_density` (N/m^3): density of the stress-free state times gravity; zero: no weight.
  WeightEnergy(const mesh::TetMesh& mesh, const Eigen::Vector3d& force_density);

  [[nodiscard]] bool empty() const { return force_.size() == 0; }
  /// Energy (J) at node positions x (3 N, m) over that of the mesh as it was made.
  [[nodiscard]] double value(const Eigen::VectorXd& x) const { return empty() ? 0.0 : -force_.dot(x - rest_); }
  /// Energy (J); adds `factor` times its derivative (N) to `gradient` (3 N).
  double gradient(const Eigen::VectorXd& x, double factor, Eigen::VectorXd& gradient) const;

private:
  Eigen::VectorXd force_, rest_;  // N, m
};

}  // namespace palpate::fem
