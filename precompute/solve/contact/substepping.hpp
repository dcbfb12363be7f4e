// SPDX-License-Identifier: GPL-3.0-or-later
// A move of the tool in one step, or in substeps where a step finds no equilibrium.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

namespace palpate::solve {

struct StepResult {
  bool converged = false;
  bool peels = false;  ///< most of a sticking contact lets go in the end: no mesh and no contact method mends that
  std::string cause;
  std::uint32_t iterations = 0;
  double energy_error = 0.0;  ///< J, half of the last decrement: how far above its minimum the energy may be
};

/// Calls step(to, part) for shares `to` of the move, up to 1; a step that fails is halved, down to an eighth of the
/// move. If the smallest share fails too, or the contact peels, the result has its cause, and the move ends at the last
/// good step.
template <class Step>
StepResult substep(Step&& step) {
  StepResult total;
  double done = 0.0, part = 1.0;
  while (done < 1.0) {
    const double next = std::min(1.0, done + part);
    const StepResult s = step(next, part);
    total.iterations += s.iterations;
    total.cause = s.cause;
    total.peels = s.peels;
    total.energy_error = s.energy_error;
    if (s.converged) {
      done = next;
      continue;
    }
    part *= 0.5;
    if (s.peels || part < 1.0 / 8) return total;
  }
  total.converged = true;
  total.cause.clear();
  return total;
}

}  // namespace palpate::solve
