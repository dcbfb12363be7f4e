// SPDX-License-Identifier: GPL-3.0-or-later
// Pressure inside cavities: a load that follows their walls and still has a potential, -p times the enclosed volume.
#pragma once

#include "precompute/fem/elastic.hpp"

#include <array>
#include <vector>

namespace palpate::fem {

/// Six nodes a face, counter-clockwise seen from outside of the body.
using MeshFaces = std::vector<std::array<std::int32_t, 6>>;

/// The closed parts of the mesh's boundary that enclose a void (their volume is negative), one entry a cavity, in the
/// order of their first faces.
std::vector<MeshFaces> cavity_walls(const mesh::TetMesh& mesh);

class PressureEnergy {
public:
  /// `walls`: faces of `mesh` that together are closed and face into what they enclose.
  PressureEnergy(const mesh::TetMesh& mesh, MeshFaces walls, double pressure);

  [[nodiscard]] bool empty() const { return walls_.empty(); }
  /// Enclosed volume (m^3) at node positions x (3 N, m): exact for the quadratic faces.
  [[nodiscard]] double volume(const Eigen::VectorXd& x) const;
  /// Energy (J) over that of the mesh as it was made.
  [[nodiscard]] double value(const Eigen::VectorXd& x) const {
    return empty() ? 0.0 : -pressure_ * (volume(x) - rest_volume_);
  }
  /// Energy (J); adds `factor` times its derivative (N) to `gradient` (3 N).
  double gradient(const Eigen::VectorXd& x, double factor, Eigen::VectorXd& gradient) const;
  /// Adds `factor` times the second derivative (N/m), which is indefinite: nothing of it is in the convex kind.
  void hessian(const Eigen::VectorXd& x, HessianKind kind, double factor, BlockMatrix& matrix) const;

private:
  MeshFaces walls_;
  double pressure_ = 0.0, rest_volume_ = 0.0;
  Eigen::Vector3d centre_{0, 0, 0};  // volumes are measured from here: any point will do, one near loses least
};

}  // namespace palpate::fem
