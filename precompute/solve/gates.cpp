// SPDX-License-Identifier: GPL-3.0-or-later
// Each gate guards against one way of being silently wrong.
#include "precompute/solve/gates.hpp"

#include <cmath>
#include <cstdio>

namespace palpate {
namespace {

std::string say(const char* gate, double figure, double limit, double depth) {
  char text[160];
  std::snprintf(text, sizeof text, "%s: %.3g against a limit of %.3g at depth %.3g mm", gate, figure, limit,
                1e3 * depth);
  return text;
}

}  // namespace

std::optional<std::string> failed_gate(const GateState& s, const GateLimits& limits) {
  if (!std::isfinite(s.force) || !std::isfinite(s.stored)) {
    return "finite: the force or energy is not a number at depth " + std::to_string(1e3 * s.depth) + " mm";
  }
  // An element turned inside out can still be an equilibrium.
  if (!(s.min_jacobian > limits.min_jacobian)) {
    return say("minimum Jacobian", s.min_jacobian, limits.min_jacobian, s.depth);
  }
  // A tool that slipped between integration points, or a penalty too soft.
  if (s.contact.penetration > limits.penetration * s.contact_radius) {
    return say("penetration over contact radius", s.contact.penetration / s.contact_radius, limits.penetration,
               s.depth);
  }
  if (s.force <= 0) return say("force sign (N)", s.force, 0.0, s.depth);
  if (s.force < limits.force_drop * s.previous_force) {
    return say("force growth", s.force / s.previous_force, limits.force_drop, s.depth);
  }
  // Work that is not stored means a jump to another branch, or contact lost and found.
  const double imbalance = std::abs(s.stored - s.work), scale = s.work + 0.01 / limits.energy_balance * s.energy_scale;
  if (imbalance > limits.energy_balance * scale) {
    return say("energy balance", (s.stored - s.work) / scale, limits.energy_balance, s.depth);
  }
  return std::nullopt;
}

}  // namespace palpate
