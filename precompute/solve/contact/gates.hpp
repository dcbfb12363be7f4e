// SPDX-License-Identifier: GPL-3.0-or-later
// The checks that every solved point passes before it is accepted; a failed one names itself and its figure.
#pragma once

#include "formats/journal/samples.hpp"
#include "precompute/solve/contact/contact.hpp"

#include <optional>
#include <string>

namespace palpate::solve {

struct GateLimits {
  double penetration = 0.03;           ///< of the contact radius
  double bond_give = 0.03;             ///< of the contact radius, mean over a bonded contact
  double bond_gap = 0.2;               ///< of the contact radius, at a point: tension at the rim of a bond is singular
  double min_jacobian = 0.0;           ///< an element turned inside out at a quadrature point is refused
  double force_drop = 0.9;             ///< smallest ratio of the normal force to the one before
  double tangential_response = 1e-3;   ///< of the normal force: a tangential response below has no sign of its own,
                                       ///< because it is less than what the solve's tolerance leaves in a force
  double energy_balance = 0.06;        ///< of the tool's work, and a hundredth of the energy scale of the whole push
  double finer_mesh = 0.1;             ///< relative difference of the force to a finer mesh, see PairCheck
  double mesh_error = 0.05;            ///< relative, of the force at full depth: a larger estimate needs a finer mesh
  std::size_t curve_points = 3;        ///< resolved depths of a normal curve (all, where fewer were requested)
  std::uint32_t resolved_points = 12;  ///< integration points in contact at the deepest and at a tangential push
};

/// One point of a push as the gates see it.
struct GateState {
  double depth = 0.0;           ///< m
  double contact_radius = 0.0;  ///< m
  double force = 0.0;           ///< N along the outward normal
  double previous_force = 0.0;  ///< N
  double work = 0.0;            ///< J done by the tool so far
  double stored = 0.0;          ///< J elastic and contact energy above the start
  double energy_scale = 0.0;    ///< J of the whole push: shallow points are judged by it too
  double min_jacobian = 1.0;
  ContactReport contact;
};

/// Whether the tool is in surface that is held: no other contact method mends that.
bool sinks_into_held(const GateState& state, const GateLimits& limits);

/// Empty when the state passes; else the name of the gate, the figure and its limit.
std::optional<std::string> failed_gate(const GateState& state, const GateLimits& limits);

/// failed_gate for a tangential push: `answer` (N) is the change of the force along the push, which must oppose it
/// except for limits.tangential_response. It checks no growth and no work, but a resolved contact, because a contact
/// that peels ends in a few points.
std::optional<std::string> failed_tangential_gate(const GateState& state, double answer, const GateLimits& limits);

/// The same for a contact that sticks, where `work` and `stored` count from the normal indentation.
std::optional<std::string> failed_sticking_gate(const GateState& state, double answer, const GateLimits& limits);

/// The same for a contact that is grasped, in any move: a pull is as good as a push, and `work` and `stored` count from
/// the grasp. `answer` (N, or N m of a turn) is the change of the force along the move.
std::optional<std::string> failed_grasp_gate(const GateState& state, double answer, const GateLimits& limits);

/// The same with Coulomb friction, where work and stored energy are known from the start of the tangential push: what
/// the tool did is stored or was `dissipated` (J, >= 0).
std::optional<std::string> failed_slip_gate(const GateState& state, double answer, double dissipated,
                                            const GateLimits& limits);

/// For a tool that may let go and come back, its energies known from before the first touch: the balance is judged by
/// the `most_work` (J) that was in body and friction so far.
std::optional<std::string> failed_stroke_gate(const GateState& state, double most_work, double dissipated,
                                              const GateLimits& limits);

/// Empty where the check found nothing wrong, or nothing to compare.
std::optional<std::string> failed_check(const PairCheck& check, const GateLimits& limits);

}  // namespace palpate::solve
