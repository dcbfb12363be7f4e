// SPDX-License-Identifier: GPL-3.0-or-later
// Energies of the distortion alone: the isochoric split of general packages.
#pragma once

#include "precompute/fem/materials/law.hpp"

#include <memory>
#include <utility>
#include <vector>

namespace palpate::fem {

/// mu/2 (D:D - 3) + the laws at D, where D = J^(-1/3) F and J = det F (Flory 1961, equation 9): a change of volume
/// alone costs no energy. Below J = 0.1 the power of J goes on as a parabola.
class Distortion final : public Law {
public:
  Distortion(double mu, std::vector<std::shared_ptr<const Law>> laws) : mu_(mu), laws_(std::move(laws)) {}

  [[nodiscard]] double energy(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre) const override;
  double stress(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre, Eigen::Matrix3d& stress) const override;
  [[nodiscard]] Tangent tangent(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre) const override;

private:
  // Energy of the distortion; sets its derivative there.
  double distorted(const Eigen::Matrix3d& d, const Eigen::Vector3d& fibre, Eigen::Matrix3d& slope) const;

  double mu_;  ///< Pa
  std::vector<std::shared_ptr<const Law>> laws_;
};

}  // namespace palpate::fem
