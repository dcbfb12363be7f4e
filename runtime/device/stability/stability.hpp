// SPDX-License-Identifier: MIT
// How stiff a contact a device can show: for any hand (passivity), and for a given one (onset of oscillation).
#pragma once

#include "device/simulation/sim_plant.hpp"

namespace palpate::device {

/// Times of the force loop, which samples, holds and sends.
struct LoopTiming {
  double period = 0.001;  ///< s; above 0
  double computing = 0;   ///< s from a sample's arrival to its command; at least 0
  std::optional<std::string> validate() const;
};

/// Stiffness (N/m) up to which device and loop together give no hand more energy than it put in.
struct PassiveStiffness {
  double by_damping = 0;   ///< bound by viscous damping, against hold and delay
  double by_friction = 0;  ///< bound by Coulomb friction, against encoder steps; infinite without steps
  [[nodiscard]] double least() const { return by_damping < by_friction ? by_damping : by_friction; }
};

/// With damping b, Coulomb friction f, encoder step q in `axes` directions at once, period T and delay D in all,
///
///     by_damping = 2 b / (D + T (1 + ceil(D / T))),        by_friction = 2 f / (sqrt(axes) q).
///
/// For a contact whose force f(x) is conservative, or dissipates, and has no larger slope than K: the force that acts
/// at t belongs to a sample of age s(t), and gives out more than f(x) would by at most K times the integral of |v(t)|
/// times that of |v| over the age, so by K/2 times the integral of v^2 (s + m), m being how long the next sample
/// still acts; s + m is at most D + T (1 + ceil(D / T)). Steps add at most K sqrt(axes) q / 2 times the integral of
/// |v|. Without delay it is the necessary and sufficient bound of Colgate and Schenkel (1997), b > K T / 2, and with
/// steps that of Abbott and Okamura (2005, eq. 11), K <= min(2 b / T, 2 f / q); where D is a whole number of periods it
/// is b > K (T / 2 + D) (Colgate and Schenkel; Diolaiti et al. 2006, eq. 18 for small steps).
///
/// A `damper` B (N s/m, at least 0) beside the spring, by differences of samples, takes as much of the device's damping
/// (b > K T / 2 + B, Colgate and Schenkel; late or not, it gives out no more than B times the integral of v^2), and its
/// steps take 2 B / T of the bound by friction; each remainder is at least 0.
PassiveStiffness passive_stiffness(const PlantOptions& device, const LoopTiming& timing, int axes = 3,
                                   double damper = 0);

/// The stiffness at which a given hand begins to oscillate.
struct Onset {
  double stiffness = 0;  ///< N/m; 0: always, infinite: never below 1e9 N/m
  double frequency = 0;  ///< Hz
};

/// Smallest stiffness at which device, hand, zero-order hold and delay have an eigenvalue on the unit circle.
/// `amplitude` (m, above 0) of the oscillation: friction and encoder steps count as their describing functions,
/// damping 4 f / (pi omega amplitude) and a gain of the steps; infinite: they do not count.
Onset onset_of_oscillation(const PlantOptions& plant, const LoopTiming& timing, double amplitude);

/// Whether a linear contact of this stiffness settles, without friction and steps: every root of the sampled loop's
/// characteristic polynomial within the unit circle (Schur and Cohn).
bool settles(const PlantOptions& plant, const LoopTiming& timing, double stiffness);

}  // namespace palpate::device
