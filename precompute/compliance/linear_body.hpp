// SPDX-License-Identifier: GPL-3.0-or-later
// Linear elasticity of a settled body: displacements of its sites by forces at its sites, from one factor.
#pragma once

#include "precompute/common/body.hpp"
#include "precompute/solve/pair/pair.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

namespace palpate::compliance {

/// A place of the surface that forces act on, in the state from which contact starts.
struct LoadSite {
  Eigen::Vector3d point{0, 0, 0};   ///< m
  Eigen::Vector3d normal{0, 0, 1};  ///< outward unit
};

struct LinearBodyOptions {
  double edge = 0.0;            ///< m, > 0: of the elements at the surface
  double contact_radius = 0.0;  ///< m, > 0: of the loads; at least kLoadEdges edges are taken
  solve::PairOptions solver;    ///< mesh options and materials
};

/// The second derivative of the body's energy at the equilibrium under its prestress, and its factor. Loads and
/// readings use one operator P: the traction of Hertz, sqrt(1 - r^2 / radius^2), over the surface within `radius` of a
/// site. So the compliance P^T H^-1 P is symmetric and positive semi-definite.
class LinearBody {
public:
  static constexpr double kLoadEdges = 1.5;

  /// Throws Error(numerical) where the body cannot be meshed or settled, where nothing holds it, and where the second
  /// derivative is not positive definite, which names a body that buckles under its prestress.
  LinearBody(const Body& body, const std::vector<LoadSite>& sites, const LinearBodyOptions& options);
  ~LinearBody();

  /// Displacements of all sites by unit forces along x, y, z at each of `sites` (3 sites x 3 of these, m/N). Several at
  /// once take little more time than one.
  [[nodiscard]] Eigen::MatrixXd columns(const std::vector<std::size_t>& sites) const;
  /// m, of the loads.
  [[nodiscard]] double load_radius() const;
  [[nodiscard]] std::size_t nodes() const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::compliance
