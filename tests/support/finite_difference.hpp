// SPDX-License-Identifier: GPL-3.0-or-later
// Central differences of an energy, for comparing with its analytic derivatives.
#pragma once

#include "precompute/fem/minimiser.hpp"

#include <algorithm>

namespace palpate::test {

/// Largest difference of gradient and central difference over all coordinates, relative to the largest entry.
inline double gradient_error(const EnergyProblem& problem, const Eigen::VectorXd& x, double step) {
  Eigen::VectorXd g(x.size()), y = x;
  problem.gradient(x, g);
  double worst = 0;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    y[k] = x[k] + step;
    const double up = problem.value(y);
    y[k] = x[k] - step;
    const double down = problem.value(y);
    y[k] = x[k];
    worst = std::max(worst, std::abs((up - down) / (2 * step) - g[k]));
  }
  return worst / std::max(g.cwiseAbs().maxCoeff(), 1e-300);
}

/// The same for the Hessian (all nodes free) against differences of the gradient.
inline double hessian_error(const EnergyProblem& problem, const TetMesh& mesh, const Eigen::VectorXd& x, double step) {
  BlockMatrix matrix(mesh, std::vector<char>(mesh.nodes.size(), 0));
  matrix.set_zero();
  problem.hessian(x, HessianKind::exact, matrix);
  const Eigen::MatrixXd lower = matrix.matrix();
  const Eigen::MatrixXd h = lower.selfadjointView<Eigen::Lower>();
  Eigen::VectorXd up(x.size()), down(x.size()), y = x;
  double worst = 0;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    y[k] = x[k] + step;
    problem.gradient(y, up);
    y[k] = x[k] - step;
    problem.gradient(y, down);
    y[k] = x[k];
    worst = std::max(worst, ((up - down) / (2 * step) - h.col(k)).cwiseAbs().maxCoeff());
  }
  return worst / h.cwiseAbs().maxCoeff();
}

/// Node positions of a mesh as one vector (3 N).
inline Eigen::VectorXd stacked(const TetMesh& mesh) {
  Eigen::VectorXd x(3 * static_cast<Eigen::Index>(mesh.nodes.size()));
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) x.segment<3>(3 * static_cast<Eigen::Index>(n)) = mesh.nodes[n];
  return x;
}

}  // namespace palpate::test
