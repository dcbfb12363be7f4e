// SPDX-License-Identifier: GPL-3.0-or-later
// Each gate guards against one way of being silently wrong.
#include "precompute/solve/contact/gates.hpp"

#include <cmath>
#include <cstdio>

namespace palpate::solve {
namespace {

std::string describe(const char* gate, double figure, double limit, double depth) {
  char text[160];
  std::snprintf(text, sizeof text, "%s: %.3g against a limit of %.3g at depth %.3g mm", gate, figure, limit,
                1e3 * depth);
  return text;
}

}  // namespace

bool sinks_into_held(const GateState& s, const GateLimits& limits) {
  return s.contact.held_overlap > limits.penetration * s.contact_radius;
}

namespace {

// The conditions of every accepted contact, pressed or pulled.
std::optional<std::string> failed_state(const GateState& s, const GateLimits& limits) {
  if (!std::isfinite(s.force) || !std::isfinite(s.stored)) {
    return "finite: the force or energy is not a number at depth " + std::to_string(1e3 * s.depth) + " mm";
  }
  // An element turned inside out can still be an equilibrium.
  if (!(s.min_jacobian > limits.min_jacobian)) {
    return describe("minimum Jacobian", s.min_jacobian, limits.min_jacobian, s.depth);
  }
  // A held surface exerts no force, so a tool that sinks into it is not in the intended contact.
  if (sinks_into_held(s, limits)) {
    return describe("support: overlap of tool and held surface over contact radius",
                    s.contact.held_overlap / s.contact_radius, limits.penetration, s.depth);
  }
  // A penalty too soft for this contact.
  if (s.contact.penetration > limits.penetration * s.contact_radius) {
    return describe("penetration over contact radius", s.contact.penetration / s.contact_radius, limits.penetration,
                    s.depth);
  }
  return std::nullopt;
}

// A contact that is not bonded can only press, whatever way the tool came.
std::optional<std::string> failed_contact(const GateState& s, const GateLimits& limits) {
  if (auto failed = failed_state(s, limits)) return failed;
  if (s.force <= 0) return describe("force sign (N)", s.force, 0.0, s.depth);
  return std::nullopt;
}

// `most` (N, N m): an answer below it opposes the move, or has no sign.
std::optional<std::string> failed_answer(const char* name, const GateState& s, double answer, double most,
                                         const GateLimits& limits) {
  if (!(answer < most)) return describe(name, answer, most, s.depth);
  if (s.contact.points < limits.resolved_points) {
    return describe("contact resolution (points)", s.contact.points, limits.resolved_points, s.depth);
  }
  return std::nullopt;
}

// Work that is not stored means a jump to another branch, or contact lost and found.
std::optional<std::string> failed_balance(const GateState& s, double imbalance, double work, const GateLimits& limits) {
  const double scale = work + 0.01 / limits.energy_balance * s.energy_scale;
  if (std::abs(imbalance) > limits.energy_balance * scale) {
    return describe("energy balance", imbalance / scale, limits.energy_balance, s.depth);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> failed_gate(const GateState& s, const GateLimits& limits) {
  if (auto failed = failed_contact(s, limits)) return failed;
  if (s.force < limits.force_drop * s.previous_force) {
    return describe("force growth", s.force / s.previous_force, limits.force_drop, s.depth);
  }
  return failed_balance(s, s.stored - s.work, s.work, limits);
}

std::optional<std::string> failed_tangential_gate(const GateState& s, double answer, const GateLimits& limits) {
  if (auto failed = failed_contact(s, limits)) return failed;
  return failed_answer("tangential response (N)", s, answer, limits.tangential_response * s.force, limits);
}

std::optional<std::string> failed_sticking_gate(const GateState& s, double answer, const GateLimits& limits) {
  if (auto failed = failed_tangential_gate(s, answer, limits)) return failed;
  return failed_balance(s, s.stored - s.work, std::abs(s.work), limits);
}

std::optional<std::string> failed_grasp_gate(const GateState& s, double answer, const GateLimits& limits) {
  if (auto failed = failed_state(s, limits)) return failed;
  const double give = s.contact.bond_give.norm() / s.contact_radius, gap = s.contact.bond_gap / s.contact_radius;
  if (give > limits.bond_give) return describe("give of the bond over contact radius", give, limits.bond_give, s.depth);
  if (gap > limits.bond_gap) return describe("gap of the bond over contact radius", gap, limits.bond_gap, s.depth);
  if (auto failed = failed_answer("answer of the grasp (N, N m)", s, answer, 0.0, limits)) return failed;
  return failed_balance(s, s.stored - s.work, s.work, limits);
}

std::optional<std::string> failed_slip_gate(const GateState& s, double answer, double dissipated,
                                            const GateLimits& limits) {
  if (auto failed = failed_tangential_gate(s, answer, limits)) return failed;
  if (!std::isfinite(s.work) || !(dissipated >= 0)) return describe("dissipated energy (J)", dissipated, 0.0, s.depth);
  return failed_balance(s, s.stored + dissipated - s.work, s.work, limits);
}

std::optional<std::string> failed_stroke_gate(const GateState& s, double most_work, double dissipated,
                                              const GateLimits& limits) {
  if (auto failed = s.contact.points > 0 ? failed_contact(s, limits) : failed_state(s, limits)) return failed;
  if (!std::isfinite(s.work) || !(dissipated >= 0)) return describe("dissipated energy (J)", dissipated, 0.0, s.depth);
  return failed_balance(s, s.stored + dissipated - s.work, most_work, limits);
}

std::optional<std::string> failed_check(const PairCheck& check, const GateLimits& limits) {
  if (check.compared == 0 || check.difference <= limits.finer_mesh) return std::nullopt;
  char text[128];
  std::snprintf(text, sizeof text, "finer mesh: the force differs by %.3g, allowed %.3g", check.difference,
                limits.finer_mesh);
  return text;
}

}  // namespace palpate::solve
