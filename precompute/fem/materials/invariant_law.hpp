// SPDX-License-Identifier: GPL-3.0-or-later
// Isotropic energies of I1 = F:F, I2 = |cof F|^2 and J = det F, and their chain rule.
#pragma once

#include "precompute/fem/materials/law.hpp"

namespace palpate::fem {

/// W(I1, I2, J) and its derivatives in that order (Pa).
struct InvariantEnergy {
  double value = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  ///< symmetric
};

class InvariantLaw : public Law {
public:
  [[nodiscard]] double energy(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre) const final;
  double stress(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre, Eigen::Matrix3d& stress) const final;
  [[nodiscard]] Tangent tangent(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre) const final;

private:
  [[nodiscard]] virtual InvariantEnergy at(double i1, double i2, double j) const = 0;
};

/// c (I2 - 3): the second term of Mooney (1940) and Rivlin (1948).
class SecondInvariant final : public InvariantLaw {
public:
  explicit SecondInvariant(double c) : c_(c) {}

private:
  [[nodiscard]] InvariantEnergy at(double i1, double i2, double j) const override;
  double c_;
};

/// c1 (exp(beta (I1 - 3)) - 1) + c2 (I2 - 3), beta > 0 (Veronda and Westmann 1970, equation 11; with c2 = 0 the law of
/// Demiray 1972, Fung's isotropic exponential). Beyond an exponent of 30 the exponential goes on as a parabola.
class Exponential final : public InvariantLaw {
public:
  Exponential(double c1, double beta, double c2) : c1_(c1), beta_(beta), c2_(c2) {}

private:
  [[nodiscard]] InvariantEnergy at(double i1, double i2, double j) const override;
  double c1_, beta_, c2_;
};

/// lambda/2 (tr E)^2 + mu E:E of Green's strain E (St. Venant-Kirchhoff). It softens under compression.
class StVenantKirchhoff final : public InvariantLaw {
public:
  StVenantKirchhoff(double mu, double lambda) : mu_(mu), lambda_(lambda) {}

private:
  [[nodiscard]] InvariantEnergy at(double i1, double i2, double j) const override;
  double mu_, lambda_;
};

/// slope (J - 1) + bulk/2 (J - 1)^2, for the comparison element that has no mean dilatation.
class Volume final : public InvariantLaw {
public:
  Volume(double slope, double bulk) : slope_(slope), bulk_(bulk) {}

private:
  [[nodiscard]] InvariantEnergy at(double i1, double i2, double j) const override;
  double slope_, bulk_;
};

}  // namespace palpate::fem
