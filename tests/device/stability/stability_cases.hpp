// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts, devices, rates, delays and hands whose onset of oscillation is predicted and simulated.
#pragma once

#include "device/simulation/sim_device.hpp"
#include "device/stability/closed_loop.hpp"
#include "palpate/format/response_view.hpp"
#include "palpate/output/virtual_coupling.hpp"

#include <memory>
#include <string>
#include <vector>

namespace palpate::test {

using device::Response;
using device::Vec3;

/// A contact that the hand presses along -z of the device, touching at z = 0. Forces are those of scale 1.
struct ContactLaw {
  std::string name;
  double most_depth = 0;                          ///< m, no deeper
  double height = 0.002;                          ///< m, where the hand comes from; 0: it is held from the beginning
  double farthest = HUGE_VAL;                     ///< m below the touch, no deeper a device is held behind a coupling
  std::function<double(double depth)> force;      ///< N along z, slowly pressed
  std::function<double(double depth)> slope;      ///< N/m, spectral norm of the Jacobian
  std::function<double(double depth)> amplitude;  ///< m, to swing: within the contact, and without slip
  std::function<Vec3(double depth)> direction;    ///< unit, the motion that it belongs to
  std::function<Response(double scale)> make;     ///< a new contact whose forces are scaled
  /// The same behind a virtual coupling.
  std::function<Response(double scale, const runtime::CouplingOptions& options)> couple;
};

/// Linear spring on both sides, linear wall, Hertz' sphere, a curve that stiffens by e every 0.8 mm.
std::vector<ContactLaw> plain_laws();

/// A response file's tool 0 on the middle of the first triangle, through the runtime's Contact. The view must outlive
/// it.
ContactLaw file_law(const std::string& name, const runtime::View& view);

struct NamedHand {
  std::string name;
  device::Hand hand;
};
std::vector<NamedHand> hands();

struct StabilityCase {
  const device::SimKind* kind = nullptr;
  const ContactLaw* law = nullptr;
  const NamedHand* hand = nullptr;
  double rate = 1000;    ///< Hz
  double delay = 0.001;  ///< s, there and back
  double held = 0.45;    ///< of the peak force, with which the hand presses
};

/// The passivity observer's result of a trial.
struct Made {
  double most = 0;   ///< J, made at any time
  double bound = 0;  ///< J, below which the controller says it stays
};

/// J that the hand may be given beyond what it gave. The controller takes half of it for what it sees made, and leaves
/// the rest to what is on its way.
inline constexpr double kTrace = 1e-4;

/// The stiffnesses (N/m) are slopes of the scaled law at the depth where the hand's force rests.
struct StabilityResult {
  double predicted = 0, frequency = 0;  ///< N/m and Hz; infinite: none that the device can show
  double simulated = 0;                 ///< N/m; infinite: none found
  double passive = 0;                   ///< N/m, for any hand
  bool passive_oscillates = false;      ///< a trial at 0.99 of that bound
  // With the passivity controller, on contacts 1.5 and 5 times as stiff as the simulated onset:
  int controlled = 0, controlled_oscillate = 0;  ///< trials
  double given = 0;                              ///< J given to the hand beyond what it gave, most
  double made = 0, made_share = 0;               ///< J made, and its share of the controller's bound, most
  // Behind a virtual coupling that makes them as stiff as the bound for any hand, contacts 1.5, 5 and 50 times as
  // stiff:
  int coupled = 0, coupled_oscillate = 0;   ///< trials
  double coupled_given = 0;                 ///< J given to the hand, most
  double softest = HUGE_VAL, stiffest = 0;  ///< N/m, of these couplings
  int trials = 0;
};

/// The device cannot show oscillations above two encoder steps on a contact so stiff that they take half its peak
/// force.
StabilityResult examine(const StabilityCase& c);

/// The response as the controller lets it through: limited to the device's peak force, half its friction credited.
/// `made` must outlive it.
Response controlled(const StabilityCase& c, const Response& response, Made& made);

/// One trial of a case whose law is scaled so; the same behind a coupling.
device::Swing swing(const StabilityCase& c, double scale, const Response& response);
device::Swing coupled_swing(const StabilityCase& c, double scale, const runtime::CouplingOptions& coupling);

/// The case's device with its hand and delays.
device::PlantOptions plant_of(const StabilityCase& c);

/// Scale at which the slope at the resting depth is this (N/m).
double scale_of(const StabilityCase& c, double stiffness);

}  // namespace palpate::test
