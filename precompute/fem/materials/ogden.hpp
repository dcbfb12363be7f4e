// SPDX-License-Identifier: GPL-3.0-or-later
// Ogden's energy of the principal stretches.
#pragma once

#include "precompute/fem/materials/law.hpp"

#include <vector>

namespace palpate::fem {

/// sum over terms of mu/alpha (l1^alpha + l2^alpha + l3^alpha - 3) of the principal stretches (Ogden 1972, equation 3).
/// Below a squared stretch of 0.1 the powers go on as parabolas; a stretch has no sign: inversion is the volume's to
/// resist.
class Ogden final : public Law {
public:
  struct Term {
    double mu;     ///< Pa
    double alpha;  ///< not 0
  };
  explicit Ogden(std::vector<Term> terms) : terms_(std::move(terms)) {}

  [[nodiscard]] double energy(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre) const override;
  double stress(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre, Eigen::Matrix3d& stress) const override;
  [[nodiscard]] Tangent tangent(const Eigen::Matrix3d& f, const Eigen::Vector3d& fibre) const override;

private:
  struct Principal;
  std::vector<Term> terms_;
};

}  // namespace palpate::fem
