// SPDX-License-Identifier: MIT
// The energy that the hand has put into a contact and not got back, and the depth whose work it covers.
#pragma once

#include "palpate/math/vec3.hpp"
#include "palpate/response/response_law.hpp"

#include <cmath>

namespace palpate::runtime {

/// Constants of the energy rule.
struct EnergyConstants {
  /// Newton steps for the counted depth, on the square root of W, which is nearly linear in the depth.
  static constexpr int kNewtonSteps = 2;
  /// Largest correction of the counted depth in a tick, over the way of tool and response. It bounds the change of the force
  /// per metre; one tick's own work needs no correction.
  static constexpr double kCorrection = 1.5;
  /// Rounds in which d is lowered within a tick, and the share of W(d) that may be missing without one: ticks of a
  /// hand's motion need none.
  static constexpr int kRounds = 2;
  static constexpr double kMissing = 0.02;
  /// Of Z: a depth that is missing by less is rounding, and the whole depth counts.
  static constexpr double kRounding = 1e-12;
  /// Travel over which an energy that the contact no longer stores is kept: this times the scale of the tool's radius.
  /// A dip of the stored energy on the way over a bump is shorter.
  static constexpr double kHoldTravel = 0.5;
  /// Slip limit of the recovery layer, 2 kappa F sqrt(r (1 - r)): the drag is at most kappa F. After a total loss 90 %
  /// of the force is back after 4.7 depths of travel at 0.1 (2.4 at 0.2, 9.3 at 0.05), without friction.
  static constexpr double kRecovery = 0.1;
  /// Least share r = E / W in that limit, so that recovery begins from no energy at all.
  static constexpr double kLeastShare = 1e-5;
};

/// E of one contact (J). One rule: E grows by the work of the hand and is at most what the contact stores at full
/// depth, or stored a little while ago.
class EnergyTank {
public:
  [[nodiscard]] double energy() const { return energy_; }

  void reset() { energy_ = hold_ = 0; }

  /// Ends a tick with `energy` (J) in the contact and `stored` (J) stored at full depth; `moved`: the tool's travel in
  /// the tick over kHoldTravel times the radius.
  void settle(double energy, double stored, double moved) {
    hold_ = larger(stored, hold_ * larger(0, 1 - moved));
    energy_ = smaller(larger(energy, 0), larger(hold_, 0));
  }

  /// Slip limit (N) of the recovery layer where the share r of W is in the contact, with F (N) at full depth:
  /// 2 kappa F sqrt(r (1 - r)).
  static double recovery_limit(double share, double force) {
    const double r = smaller(larger(share, EnergyConstants::kLeastShare), 1.0);
    return 2 * EnergyConstants::kRecovery * force * std::sqrt(r * (1 - r));
  }

  /// The depth d in [0, z] with W(d) = `energy` (J), by Newton's method on sqrt(W) from the last counted depth. W is
  /// monotone; `work` is W(z).
  static double counted_depth(const ResponseLaw& law, double energy, double z, double work, double last) {
    if (!(energy > 0)) return 0;
    if (!(energy < work)) return z;
    const double wanted = std::sqrt(energy);
    // W grows at least like z and at most like z^4, so this start is near the root where the last depth says nothing.
    double d = smaller(z, larger(last, z * std::sqrt(energy / work)));
    for (int step = 0; step < EnergyConstants::kNewtonSteps; ++step) {
      const NormalResponse r = law.normal(d);
      if (!(r.normal_force > 0)) break;
      const double root = std::sqrt(r.work);
      d += 2 * root * (wanted - root) / r.normal_force;
      d = smaller(larger(d, 1e-6 * z), z);
    }
    return d;
  }

private:
  double energy_ = 0;  ///< J
  double hold_ = 0;    ///< J, most that E may be
};

}  // namespace palpate::runtime
