// SPDX-License-Identifier: GPL-3.0-or-later
// Strain energies beyond mu/2 (F:F - 3), evaluated point by point; every one is defined for inverted states too.
#pragma once

#include <Eigen/Core>

namespace palpate::fem {

/// dP/dF (Pa) with matrices stacked by columns: index i + 3 a stands for F(i, a).
using Tangent = Eigen::Matrix<double, 9, 9>;

/// A strain energy W of the deformation gradient F (Pa), and of the unit fibre direction of the stress-free state
/// (zero where the material has none). Twice differentiable for every finite F, inverted or flat.
class Law {
public:
  virtual ~Law() = default;
  [[nodiscard]] virtual double energy(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre) const = 0;
  /// Energy; sets `stress` to the first Piola-Kirchhoff stress dW/dF (Pa).
  virtual double stress(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre, Eigen::Matrix3d& stress) const = 0;
  [[nodiscard]] virtual Tangent tangent(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre) const = 0;
};

/// The tangent with its eigenvalues raised to a millionth of the largest where they are below it.
Tangent positive_part(const Tangent& tangent);

}  // namespace palpate::fem
