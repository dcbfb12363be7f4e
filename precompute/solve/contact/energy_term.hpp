// SPDX-License-Identifier: GPL-3.0-or-later
// A term of a push's energy beside the body and its first tool.
#pragma once

#include "precompute/fem/elastic.hpp"
#include "precompute/fem/matrix/block_matrix.hpp"

#include <Eigen/Core>

namespace palpate::solve {

/// A part of the energy of all node positions (3 N, m).
class EnergyTerm {
public:
  virtual ~EnergyTerm() = default;
  [[nodiscard]] virtual double value(const Eigen::VectorXd& x) const = 0;
  /// Energy (J); adds its derivative (N) to `gradient` (3 N).
  virtual double gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const = 0;
  /// Adds the second derivative (N/m).
  virtual void hessian(const Eigen::VectorXd& x, fem::HessianKind kind, fem::BlockMatrix& matrix) const = 0;
};

}  // namespace palpate::solve
