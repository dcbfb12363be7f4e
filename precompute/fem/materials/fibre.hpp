// SPDX-License-Identifier: GPL-3.0-or-later
// Fibres that stiffen when they are stretched.
#pragma once

#include "precompute/fem/materials/law.hpp"

namespace palpate::fem {

/// k1/(2 k2) (exp(k2 <E>^2) - 1) with E = kappa (I1 - 3) + (1 - 3 kappa) (I4 - 1), I4 the squared stretch along the
/// fibres and <E> its positive part: fibres carry tension alone (Gasser, Ogden and Holzapfel 2006, equations 11 and 12,
/// of the whole deformation). kappa in [0, 1/3]: from aligned to scattered evenly.
class Fibres final : public Law {
public:
  Fibres(double k1, double k2, double kappa) : k1_(k1), k2_(k2), kappa_(kappa) {}
  [[nodiscard]] double energy(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre) const override;
  double stress(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre, Eigen::Matrix3d& stress) const override;
  [[nodiscard]] Tangent tangent(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre) const override;

private:
  struct Stretch;
  double k1_;  ///< Pa
  double k2_;  ///< > 0
  double kappa_;
};

}  // namespace palpate::fem
