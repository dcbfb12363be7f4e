// SPDX-License-Identifier: GPL-3.0-or-later
// Steps, their starts, and the gates between them.
#include "precompute/solve/contact/settle.hpp"

#include "precompute/solve/contact/gates.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace palpate::solve {
namespace {

using Eigen::VectorXd;

constexpr double kFirst = 0.25;       // share of a step
constexpr double kLeast = 1.0 / 128;  // smallest share of a step before the loads count as too large
constexpr double kImbalance = 0.1;    // of the energy of a step that its potentials may leave unexplained
constexpr double kResidual = 1e-2;    // of the body's nodal forces; energies say more where volumes are nearly rigid
constexpr double kStepEnergy = 1e-6;  // error of a step's energy, of the energy of the step
constexpr double kLastResidual = 1e-4;
constexpr int kIterations = 60;

std::string percent(const char* text, double share) {
  char line[160];
  std::snprintf(line, sizeof line, text, 100 * share);
  return line;
}

struct State {
  VectorXd x;
  double share = 0.0;
  double energy = 0.0;  // J
  BodyEnergy::Slope slope;
};

class Stepping {
public:
  Stepping(BodyEnergy& body, fem::Minimiser& minimiser) : body_(body), minimiser_(minimiser) {}

  Settled run(VectorXd& x, double energy_tolerance) {
    now_ = {x, 0.0, body_.value(x), body_.slope(x)};
    double part = kFirst;
    while (now_.share < 1) {
      const double next = std::min(1.0, now_.share + part);
      if (step(next)) {
        result_.share = next;
        ++result_.steps;
        part = std::min(kFirst, 2 * part);
        continue;
      }
      minimiser_.drop_factor();
      part /= 2;
      if (part < kLeast) return stopped();
    }
    if (!polish(energy_tolerance)) return stopped();
    result_.reached = true;
    result_.cause.clear();
    x = now_.x;
    return result_;
  }

private:
  // The cause of the last step says why it stopped.
  Settled& stopped() {
    result_.cause =
        percent("the prestress has an equilibrium up to %.3g %% of its loads; beyond: ", result_.share) + result_.cause;
    body_.set_share(result_.share);
    return result_;
  }

  // The guess of least energy: as the supports go, or on along the last step.
  [[nodiscard]] VectorXd start(double share) const {
    const double ahead = share - now_.share;
    VectorXd best = now_.x;
    if (body_.stretch_motion().size() > 0) best += ahead * body_.stretch_motion();
    body_.hold(best);
    if (!(now_.share > before_.share)) return best;
    VectorXd on = now_.x + ahead / (now_.share - before_.share) * (now_.x - before_.x);
    body_.hold(on);
    const double energy = body_.value(on);
    return std::isfinite(energy) && energy < body_.value(best) ? on : best;
  }

  bool minimise(VectorXd& x, double energy_tolerance, double residual) {
    fem::MinimiserOptions options;
    options.energy_tolerance = energy_tolerance;
    options.residual_tolerance = residual;
    options.max_iterations = kIterations;
    const fem::MinimiserResult m = minimiser_.minimise(body_, x, options);
    result_.iterations += static_cast<std::uint32_t>(m.iterations);
    result_.factorisations += static_cast<std::uint32_t>(m.factorisations);
    if (!m.converged) result_.cause = m.cause;
    return m.converged;
  }

  // False, with the cause, where the state at this share is not accepted.
  bool step(double share) {
    body_.set_share(share);
    State next{start(share), share, 0.0, {}};
    // Its energy is known from a rough solution, which is then refined.
    if (!minimise(next.x, std::numeric_limits<double>::infinity(), kResidual)) return false;
    next.slope = body_.slope(next.x);
    if (!minimise(next.x, kStepEnergy * energy_of_step(next), kResidual)) return false;
    const double jacobian = body_.min_jacobian(next.x);
    if (!(jacobian > GateLimits{}.min_jacobian)) {
      result_.cause = "minimum Jacobian " + std::to_string(jacobian);
      return false;
    }
    next.energy = body_.value(next.x);
    next.slope = body_.slope(next.x);
    if (!balanced(next)) return false;
    result_.min_jacobian = jacobian;
    before_ = std::move(now_);
    now_ = std::move(next);
    return true;
  }

  // J: half of what the step changes in the loads times their change.
  [[nodiscard]] double energy_of_step(const State& next) const {
    return (next.share - now_.share) / 2 *
           (std::abs(next.slope.forces - now_.slope.forces) + std::abs(next.slope.supports - now_.slope.supports));
  }

  // Along equilibria the energy grows by its slope; for a body of constant stiffness the trapezium is exact.
  bool balanced(const State& next) {
    const double step = next.share - now_.share;
    const double grown = step / 2 * (now_.slope.forces + now_.slope.supports + next.slope.forces + next.slope.supports);
    const double scale = energy_of_step(next);
    const double left = std::abs(next.energy - now_.energy - grown);
    // The second term is rounding: a load that hardly deforms the body leaves nothing else.
    if (left <= kImbalance * scale + 1e-9 * std::abs(next.energy)) return true;
    result_.cause = percent("it jumps to another state (energy balance off by %.3g %% of a step)", left / scale);
    return false;
  }

  bool polish(double energy_tolerance) { return minimise(now_.x, energy_tolerance, kLastResidual); }

  BodyEnergy& body_;
  fem::Minimiser& minimiser_;
  State now_, before_;
  Settled result_;
};

}  // namespace

Settled settle(BodyEnergy& body, fem::Minimiser& minimiser, VectorXd& x, double energy_tolerance) {
  return Stepping(body, minimiser).run(x, energy_tolerance);
}

}  // namespace palpate::solve
