// SPDX-License-Identifier: GPL-3.0-or-later
// The pressure that answers a gap: a penalty, the same with multipliers (augmented Lagrange), or a log barrier.
#pragma once

#include <cmath>

namespace palpate::solve {

/// Energy, pressure and stiffness of a contact point at its gap g, per area.
struct ContactAnswer {
  double energy = 0.0;     ///< J/m^2
  double pressure = 0.0;   ///< Pa, -d energy / dg, >= 0 unless bonded
  double stiffness = 0.0;  ///< Pa/m, -d pressure / dg, >= 0
};

/// Penalty: k o^2 / 2 of the overlap o = max(0, -g). With a multiplier p0 of the point (augmented Lagrange, e.g.
/// Wriggers 2006, section 6.3.3) the overlap counts from p0 / k. Barrier: -k (g - t)^2 ln(g / t) for gaps below the
/// thickness t (Li et al. 2020, equation 6), which keeps every gap open; below its floor it goes on as its own
/// parabola, so that a search may begin at an overlap (a relaxed log barrier, Hauser and Saccon 2006) and ends at a
/// state that the barrier itself has whenever no gap is below the floor.
struct ContactLaw {
  double penalty = 0.0;    ///< Pa/m, k
  double thickness = 0.0;  ///< m, t; 0: no barrier but a penalty
  double floor = 0.0;      ///< m, in (0, t)

  [[nodiscard]] bool barrier() const { return thickness > 0; }
  /// Multiplier `held` (Pa, >= 0) of the point; a barrier has none.
  [[nodiscard]] ContactAnswer answer(double gap, double held) const {
    if (barrier()) return gap < thickness ? beneath(gap) : ContactAnswer{};
    const double overlap = (held > 0 ? held / penalty : 0.0) - gap;
    if (!(overlap > 0)) return {};
    return {0.5 * penalty * overlap * overlap, penalty * overlap, penalty};
  }
  /// The answer of a bonded point: the penalty alone, for gaps of either sign.
  [[nodiscard]] ContactAnswer bonded(double gap) const { return {0.5 * penalty * gap * gap, -penalty * gap, penalty}; }

private:
  [[nodiscard]] ContactAnswer beneath(double gap) const {
    const double g = gap > floor ? gap : floor, u = g - thickness, log = std::log(g / thickness);
    ContactAnswer a{-penalty * u * u * log, penalty * (2 * u * log + u * u / g),
                    penalty * (-2 * log - 4 * u / g + u * u / (g * g))};
    const double below = g - gap;
    a.energy += below * (a.pressure + 0.5 * below * a.stiffness);
    a.pressure += below * a.stiffness;
    return a;
  }
};

}  // namespace palpate::solve
