// SPDX-License-Identifier: GPL-3.0-or-later
// L-BFGS on a stale CHOLMOD factor (two-loop recursion of Nocedal and Wright 2006, algorithm 7.4).
#include "precompute/fem/minimiser.hpp"

#include "precompute/fem/matrix/factor.hpp"

#include <cmath>
#include <deque>

namespace palpate::fem {
namespace {

using Eigen::VectorXd;

struct Correction {
  VectorXd s, y;
  double rho = 0.0;
};

}  // namespace

struct Minimiser::Impl {
  Impl(const mesh::TetMesh& mesh, const std::vector<char>& fixed, const SolveLimits& allowed)
      : matrix(mesh, fixed), factor(matrix.matrix(), allowed.factor_bytes), limits(allowed) {
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      if (!fixed[n]) free.push_back(static_cast<std::int32_t>(n));
    }
  }

  [[nodiscard]] VectorXd reduce(const VectorXd& full) const {
    VectorXd r(3 * static_cast<Eigen::Index>(free.size()));
    for (std::size_t k = 0; k < free.size(); ++k) r.segment<3>(3 * k) = full.segment<3>(3 * free[k]);
    return r;
  }

  void add(const VectorXd& step, double scale, VectorXd& x) const {
    for (std::size_t k = 0; k < free.size(); ++k) x.segment<3>(3 * free[k]) += scale * step.segment<3>(3 * k);
  }

  // Exact Hessian first; where it is indefinite, the convex one, which always has a factor.
  // `g` is the right-hand side of the first solve.
  bool refactor(const EnergyProblem& problem, const VectorXd& x, const VectorXd& g) {
    for (const HessianKind kind : {HessianKind::exact, HessianKind::convex}) {
      matrix.set_zero();
      problem.hessian(x, kind, matrix);
      if (!matrix.matrix().coeffs().isFinite().all()) return false;
      if (factor.factorise(matrix.matrix(), g)) return factored = true;
    }
    return factored = false;
  }

  BlockMatrix matrix;
  std::vector<std::int32_t> free;
  Factor factor;
  SolveLimits limits;
  bool factored = false;
  // Kept from call to call with the factor: a tool that moved on meets much the same stiffness.
  std::deque<Correction> memory;
};

Minimiser::Minimiser(const mesh::TetMesh& mesh, const std::vector<char>& fixed, const SolveLimits& limits)
    : impl_(std::make_unique<Impl>(mesh, fixed, limits)) {}
Minimiser::~Minimiser() = default;

void Minimiser::drop_factor() {
  impl_->factored = false;
  impl_->memory.clear();
}

MinimiserResult Minimiser::minimise(const EnergyProblem& problem, VectorXd& x, const MinimiserOptions& options) {
  Impl& m = *impl_;
  MinimiserResult result;
  std::deque<Correction>& memory = m.memory;
  VectorXd full(x.size()), trial = x;
  double energy = problem.gradient(x, full);
  VectorXd g = m.reduce(full);
  int on_factor = 0;

  const auto fresh_factor = [&] {
    memory.clear();
    on_factor = 0;
    ++result.factorisations;
    return m.refactor(problem, x, g);
  };
  // Over the load, which costs a pass over the contact.
  const auto residual = [&] { return result.residual = g.norm() / std::max(problem.load(x), 1e-300); };
  const auto balanced = [&] {
    return residual() <= options.residual_tolerance || g.norm() <= problem.rounding().force;
  };
  const auto fail = [&](const std::string& cause) {
    result.cause = cause;
    result.energy = energy;
    return result;
  };

  if (m.limits.out_of_time()) return fail("time limit reached");
  if (!m.factored && !fresh_factor()) return fail("the Hessian could not be factorised at the start");
  for (; result.iterations < options.max_iterations; ++result.iterations) {
    if (!std::isfinite(energy) || !g.allFinite()) return fail("the energy is not finite");
    if (m.limits.out_of_time()) return fail("time limit reached");
    const bool newton = result.factorisations > options.newton_after;
    if ((on_factor >= options.refresh || (newton && on_factor > 0)) && !fresh_factor()) {
      return fail("the Hessian could not be factorised");
    }
    VectorXd d = g;
    std::vector<double> alpha(memory.size());
    for (std::size_t k = memory.size(); k-- > 0;) {
      alpha[k] = memory[k].rho * memory[k].s.dot(d);
      d -= alpha[k] * memory[k].y;
    }
    d = m.factor.solve(d);
    for (std::size_t k = 0; k < memory.size(); ++k) {
      d += (alpha[k] - memory[k].rho * memory[k].y.dot(d)) * memory[k].s;
    }
    d = -d;
    const double slope = g.dot(d);
    result.decrement = -slope;
    if (!(slope <= 0) || !d.allFinite()) {
      if (on_factor == 0) return fail("no direction of descent");
      if (!fresh_factor()) return fail("the Hessian could not be factorised");
      continue;
    }
    if (0.5 * result.decrement <= options.energy_tolerance && balanced()) {
      result.converged = true;
      break;
    }

    // Armijo, or (near the end, where energies no longer resolve) a smaller slope at an energy no higher but for
    // rounding (Hager and Zhang 2005, section 2: the approximate Wolfe conditions).
    const double rounding = problem.rounding().energy + 1e-11 * std::abs(energy);
    double t = 1.0, next = 0.0;
    VectorXd g_next;
    bool accepted = false;
    for (int tries = 0; tries < 14 && !accepted; ++tries) {
      trial = x;
      m.add(d, t, trial);
      next = problem.gradient(trial, full);
      g_next = m.reduce(full);
      const double slope_next = g_next.dot(d);
      accepted = std::isfinite(next) && (next <= energy + 1e-4 * t * slope ||
                                         (next <= energy + rounding && std::abs(slope_next) <= 0.9 * std::abs(slope)));
      if (!accepted) {
        const double quadratic = -0.5 * slope * t * t / (next - energy - slope * t);
        t = std::isfinite(quadratic) ? std::clamp(quadratic, 0.1 * t, 0.6 * t) : 0.25 * t;
      }
    }
    if (!accepted) {
      if (on_factor == 0) {
        // Round-off floor: the step is too small to change the energy.
        if (0.5 * result.decrement <= 1e-13 * std::abs(energy) + options.energy_tolerance) {
          result.converged = balanced();
          if (result.converged) break;
        }
        return fail("the line search found no decrease (residual " + std::to_string(residual()) + ")");
      }
      if (!fresh_factor()) return fail("the Hessian could not be factorised");
      continue;
    }
    Correction c{t * d, g_next - g, 0.0};
    const double sy = c.s.dot(c.y);
    if (sy > 1e-14 * c.s.norm() * c.y.norm()) {
      c.rho = 1 / sy;
      memory.push_back(std::move(c));
      if (static_cast<int>(memory.size()) > options.memory) memory.pop_front();
    }
    x.swap(trial);
    g.swap(g_next);
    energy = next;
    ++on_factor;
  }
  result.energy = energy;
  if (!result.converged && result.cause.empty()) {
    result.cause = "no convergence in " + std::to_string(result.iterations) + " iterations (residual " +
                   std::to_string(residual()) + " of the load)";
  }
  return result;
}

}  // namespace palpate::fem
