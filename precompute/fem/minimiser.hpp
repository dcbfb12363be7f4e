// SPDX-License-Identifier: GPL-3.0-or-later
// Minimises an energy over the free nodes: L-BFGS preconditioned by a stale Cholesky factor, escalating to
// Newton and to a convexified Newton.
#pragma once

#include "precompute/common/processor_time.hpp"
#include "precompute/fem/elastic.hpp"
#include "precompute/fem/matrix/block_matrix.hpp"

#include <Eigen/Core>
#include <memory>
#include <string>

namespace palpate::fem {

/// An energy of all node positions (3 N, m).
class EnergyProblem {
public:
  virtual ~EnergyProblem() = default;
  [[nodiscard]] virtual double value(const Eigen::VectorXd& x) const = 0;
  /// Energy (J); overwrites `gradient` (3 N, N).
  virtual double gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const = 0;
  /// Adds the second derivative (N/m).
  virtual void hessian(const Eigen::VectorXd& x, HessianKind kind, BlockMatrix& matrix) const = 0;
  /// Size of the loads at x (N): what residuals are compared with.
  [[nodiscard]] virtual double load(const Eigen::VectorXd& x) const = 0;
  /// Smaller differences of energies and smaller residuals say nothing.
  [[nodiscard]] virtual Rounding rounding() const { return {}; }
};

struct MinimiserOptions {
  double energy_tolerance = 1e-12;   ///< J; converged when half the Newton decrement squared is below it ...
  double residual_tolerance = 2e-3;  ///< ... and the residual's norm is below this share of the load, or rounding
  int refresh = 30;                  ///< L-BFGS iterations of one call before a new factor is made
  int newton_after = 2;              ///< beyond this many new factors in one call every iteration is a Newton one
  int max_iterations = 100;
  int memory = 8;  ///< L-BFGS pairs
};

struct MinimiserResult {
  bool converged = false;
  std::string cause;  ///< of a failure
  int iterations = 0;
  int factorisations = 0;
  double energy = 0.0;     ///< J
  double decrement = 0.0;  ///< J, g . H^-1 g at the end
  double residual = 0.0;   ///< norm of the residual over the load
};

/// Keeps its Cholesky factor and L-BFGS pairs from call to call; one instance a mesh, used by one thread.
class Minimiser {
public:
  /// Throws Error(numerical) where a factor of the mesh's stiffness is beyond `limits`.
  Minimiser(const mesh::TetMesh& mesh, const std::vector<char>& fixed, const SolveLimits& limits = {});
  ~Minimiser();
  Minimiser(const Minimiser&) = delete;
  Minimiser& operator=(const Minimiser&) = delete;

  /// Moves x (fixed nodes stay) to a minimum near it. On failure, past the limits' deadline too, x is the last iterate.
  MinimiserResult minimise(const EnergyProblem& problem, Eigen::VectorXd& x, const MinimiserOptions& options);
  /// Forgets the factor, so that the next call starts with a fresh one.
  void drop_factor();

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::fem
