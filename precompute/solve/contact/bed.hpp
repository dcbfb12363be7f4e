// SPDX-License-Identifier: GPL-3.0-or-later
// Elastic beds and sliders: quadratic energies of the displacement of the surface they hold.
#pragma once

#include "precompute/common/body.hpp"
#include "precompute/fem/matrix/block_matrix.hpp"
#include "precompute/mesh/tet_mesh.hpp"

#include <Eigen/Core>
#include <array>
#include <vector>

namespace palpate::solve {

/// Half the integral of u . K u over the supported faces of the undeformed body, u the displacement: K is the bed's
/// stiffness times I, or for a slider a stiff spring along the face's normal alone.
class BedEnergy {
public:
  BedEnergy(const Body& body, const mesh::TetMesh& mesh);

  [[nodiscard]] bool empty() const { return faces_.empty(); }
  /// Displacements count from these node positions (3 N, m); those of the mesh at first.
  void set_foundation(const Eigen::VectorXd& x) { rest_ = x; }
  double value(const Eigen::VectorXd& x) const;
  double gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const;
  void hessian(fem::BlockMatrix& matrix) const;

private:
  struct Face {
    std::array<std::int32_t, 6> nodes;
    Eigen::Matrix3d stiffness;  // N/m
  };
  std::vector<Face> faces_;
  Eigen::VectorXd rest_;
};

}  // namespace palpate::solve
