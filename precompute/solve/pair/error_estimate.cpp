// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/pair/error_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

// Shares of two bounds that count as error: kIterate of the Cauchy-Schwarz bound, and kPenalty of the relative give,
// which is already subtracted to first order.
constexpr double kIterate = 0.2, kPenalty = 0.3;
// Against elements of 0.12 a a block's force is off by 3.8, 1.1 to 0.3, 0.4 and 0.1 % where edges grow by 1, 0.7, 0.5
// and 0.4 (palpate bench --solver), whatever the elements at the contact; few points there are worse.
constexpr double kGrowth = 0.035, kGrowthPower = 4, kPoints = 1.5;

}  // namespace

double error_estimate(const ErrorSources& s) {
  // An energy error e is one of the positions whose norm in the energy is sqrt(2 e); of the force on the tool it is at
  // most that times the norm of the contact's stiffness (Cauchy-Schwarz).
  const double iterate = kIterate * std::sqrt(2 * std::max(s.energy_error, 0.0) * s.contact_stiffness) / s.force;
  const double penalty = kPenalty * std::abs(s.give) / s.depth;
  const double mesh = kGrowth * std::pow(s.growth, kGrowthPower) + kPoints / std::max<double>(s.points, 1);
  return iterate + penalty + mesh;
}

}  // namespace palpate
