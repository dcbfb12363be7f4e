// SPDX-License-Identifier: GPL-3.0-or-later
// Hooke's law, for verification against closed forms.
#pragma once

#include "precompute/fem/materials/law.hpp"

namespace palpate::fem {

/// mu e:e + lambda/2 (tr e)^2 of the infinitesimal strain e = sym F - I. Not frame indifferent: a rotation strains it.
class Linear final : public Law {
public:
  Linear(double mu, double lambda) : mu_(mu), lambda_(lambda) {}
  [[nodiscard]] double energy(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre) const override;
  double stress(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre, Eigen::Matrix3d& stress) const override;
  [[nodiscard]] Tangent tangent(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre) const override;

private:
  double mu_, lambda_;  ///< Pa
};

}  // namespace palpate::fem
