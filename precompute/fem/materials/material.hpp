// SPDX-License-Identifier: GPL-3.0-or-later
// A hyperelastic material as the elements see it.
#pragma once

#include "precompute/fem/materials/law.hpp"

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

namespace palpate::fem {

/// Energy per volume of the stress-free state,
///   psi(F) = mu/2 (F:F - 3) + sum of laws(F) + slope (j - 1) + bulk/2 (j - 1)^2 + local/2 (det F - j)^2,
/// where j is the mean of det F over an element (no volumetric locking) and the slope makes F = I free of stress. The
/// last term is for changes of volume that have no mean: the other terms give them a negative energy,
/// -mu/6 of their square for the neo-Hookean solid, so that elements at free surfaces would develop them. With it their
/// energy is zero. Defined for inverted elements too. Without laws it is the compressible neo-Hookean solid of Smith,
/// de Goes and Kim (2018, equation 14, up to a constant).
struct Material {
  double mu = 0.0;                               ///< Pa; what is left out of `laws`, for it costs next to nothing
  std::vector<std::shared_ptr<const Law>> laws;  ///< evaluated at every quadrature point
  Eigen::Vector3d fibre{0, 0, 0};                ///< unit direction in the stress-free state; 0: none
  /// The same at a place (m) of the stress-free state, evaluated once an element in its middle; empty: `fibre`
  /// everywhere.
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> fibre_at;
  double slope = 0.0;  ///< Pa
  double bulk = 0.0;   ///< Pa
  double local = 0.0;  ///< Pa

  /// young > 0 (Pa), poisson in [0, 0.5).
  static Material neo_hookean(double young, double poisson);
  /// The energy mu/2 (F:F - 3) + laws with the volume term that gives this Poisson's ratio in [0, 0.5) at small strain.
  /// Throws std::invalid_argument where its shear modulus there is not positive.
  static Material of(double mu, std::vector<std::shared_ptr<const Law>> laws, double poisson);
  /// The same with the volume term at the quadrature points, in no mean: the plain element of general packages.
  [[nodiscard]] Material plain() const;

  /// Small-strain moduli without fibres (Pa).
  [[nodiscard]] double shear_modulus() const;
  [[nodiscard]] double bulk_modulus() const;

  [[nodiscard]] double deviatoric(const Eigen::Matrix3d& f) const;
  /// Energy; sets the stress dW/dF (Pa) of everything but the volume term.
  double stress(const Eigen::Matrix3d& f, Eigen::Matrix3d& stress) const;
  /// The tangent of the laws alone.
  [[nodiscard]] Tangent law_tangent(const Eigen::Matrix3d& f) const;

  [[nodiscard]] double volumetric(double j) const { return slope * (j - 1) + 0.5 * bulk * (j - 1) * (j - 1); }
  [[nodiscard]] double volumetric_slope(double j) const { return slope + bulk * (j - 1); }
  [[nodiscard]] double volumetric_curvature() const { return bulk; }
};

}  // namespace palpate::fem
