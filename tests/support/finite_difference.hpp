// SPDX-License-Identifier: GPL-3.0-or-later
// Central differences of an energy, for comparing with its analytic derivatives.
#pragma once

#include "precompute/fem/minimiser.hpp"

#include <algorithm>

namespace palpate::test {

/// One energy by itself as a problem. Keeps a reference to it.
template <class Energy>
class Alone final : public fem::EnergyProblem {
public:
  explicit Alone(const Energy& energy) : energy_(energy) {}
  double value(const Eigen::VectorXd& x) const override { return energy_.value(x); }
  double gradient(const Eigen::VectorXd& x, Eigen::VectorXd& g) const override {
    g.setZero();
    return energy_.gradient(x, g);
  }
  void hessian(const Eigen::VectorXd& x, fem::HessianKind kind, fem::BlockMatrix& m) const override {
    energy_.hessian(x, kind, m);
  }
  double load(const Eigen::VectorXd&) const override { return 1.0; }

private:
  const Energy& energy_;
};

/// Largest difference of gradient and central difference over all coordinates, relative to the largest entry.
inline double gradient_error(const fem::EnergyProblem& problem, const Eigen::VectorXd& x, double step) {
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
inline double hessian_error(const fem::EnergyProblem& problem, const mesh::TetMesh& mesh, const Eigen::VectorXd& x,
                            double step) {
  fem::BlockMatrix matrix(mesh, std::vector<char>(mesh.nodes.size(), 0));
  matrix.set_zero();
  problem.hessian(x, fem::HessianKind::exact, matrix);
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
inline Eigen::VectorXd stacked(const mesh::TetMesh& mesh) {
  Eigen::VectorXd x(3 * static_cast<Eigen::Index>(mesh.nodes.size()));
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) x.segment<3>(3 * static_cast<Eigen::Index>(n)) = mesh.nodes[n];
  return x;
}

}  // namespace palpate::test
