// SPDX-License-Identifier: GPL-3.0-or-later
// Energy of a meshed body without a tool: elasticity, capsule, elastic supports, and the loads of its prestress.
#pragma once

#include "precompute/common/body.hpp"
#include "precompute/fem/elastic.hpp"
#include "precompute/fem/membrane.hpp"
#include "precompute/fem/minimiser.hpp"
#include "precompute/fem/pressure.hpp"
#include "precompute/fem/weight.hpp"
#include "precompute/solve/contact/bed.hpp"

#include <vector>

namespace palpate::solve {

/// Per node of the mesh: a fixed support of `body` holds it.
std::vector<char> fixed_nodes(const Body& body, const mesh::TetMesh& mesh);

class BodyEnergy final : public fem::EnergyProblem {
public:
  /// `body` is free of stress, as its mesh is; its prestress begins at share 0. Nodes of the boundary that a fixed
  /// support holds stay, or follow the prescribed stretch.
  /// `materials` per region; empty: the body's. Throws Error(bad_input) where pressure finds no cavity.
  BodyEnergy(const Body& body, const mesh::TetMesh& mesh, const std::vector<fem::Material>& materials = {});

  /// Scales weight, pressure and stretch; in [0, 1].
  void set_share(double share);
  /// Puts the fixed nodes of x where the share has them.
  void hold(Eigen::VectorXd& x) const;

  /// Node positions of the mesh (3 N, m).
  [[nodiscard]] const Eigen::VectorXd& rest() const { return rest_; }
  [[nodiscard]] const std::vector<char>& fixed() const { return fixed_; }
  [[nodiscard]] bool held_anywhere() const;
  [[nodiscard]] double min_jacobian(const Eigen::VectorXd& x) const { return elastic_.min_jacobian(x); }
  /// Volume enclosed by the walls under pressure (m^3).
  [[nodiscard]] double cavity_volume(const Eigen::VectorXd& x) const { return pressure_.volume(x); }
  /// Displacement of the nodes (3 N, m) by the whole prescribed stretch if it were unhindered; empty without one.
  [[nodiscard]] const Eigen::VectorXd& stretch_motion() const { return motion_; }

  /// J that the energy of an equilibrium x grows by per share: by forces and by the movement of supports.
  struct Slope {
    double forces = 0.0, supports = 0.0;
  };
  [[nodiscard]] Slope slope(const Eigen::VectorXd& x) const;

  // EnergyProblem
  [[nodiscard]] double value(const Eigen::VectorXd& x) const override;
  double gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const override;
  void hessian(const Eigen::VectorXd& x, fem::HessianKind kind, fem::BlockMatrix& matrix) const override;
  /// N: norm of the body's nodal forces, which loads and supports balance.
  [[nodiscard]] double load(const Eigen::VectorXd& x) const override;
  [[nodiscard]] fem::Rounding rounding() const override { return elastic_.rounding(); }

private:
  Eigen::VectorXd rest_;
  std::vector<char> fixed_;
  fem::ElasticEnergy elastic_;
  fem::MembraneEnergy membrane_;
  BedEnergy bed_;
  fem::WeightEnergy weight_;
  fem::PressureEnergy pressure_;
  Eigen::VectorXd motion_;
  double share_ = 0.0;
  double rest_energy_ = 0.0;  // J
};

}  // namespace palpate::solve
