// SPDX-License-Identifier: GPL-3.0-or-later
// Integrals of the ten shape functions of a straight-sided tetrahedron: -1/20 of its volume at corners, 1/5 at middles.
#include "precompute/fem/weight.hpp"

#include <Eigen/Geometry>

namespace palpate::fem {

using Eigen::Vector3d;
using Eigen::VectorXd;

WeightEnergy::WeightEnergy(const mesh::TetMesh& mesh, const Vector3d& force_density) {
  if (force_density.isZero(0)) return;
  const auto size = 3 * static_cast<Eigen::Index>(mesh.nodes.size());
  force_ = VectorXd::Zero(size);
  rest_.resize(size);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    rest_.segment<3>(3 * static_cast<Eigen::Index>(n)) = mesh.nodes[n];
  for (const auto& t : mesh.tets) {
    const Vector3d a = mesh.nodes[t[1]] - mesh.nodes[t[0]], b = mesh.nodes[t[2]] - mesh.nodes[t[0]],
                   c = mesh.nodes[t[3]] - mesh.nodes[t[0]];
    const Vector3d whole = a.cross(b).dot(c) / 6 * force_density;
    for (std::size_t n = 0; n < 10; ++n)
      force_.segment<3>(3 * t[n]) += n < 4 ? Vector3d(-whole / 20) : Vector3d(whole / 5);
  }
}

double WeightEnergy::gradient(const VectorXd& x, double factor, VectorXd& gradient) const {
  if (empty()) return 0.0;
  gradient -= factor * force_;
  return value(x);
}

}  // namespace palpate::fem
