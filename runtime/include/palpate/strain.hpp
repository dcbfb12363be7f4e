// SPDX-License-Identifier: MIT
// What the hand gave sideways where the forces there are no gradient of an energy.
#pragma once

#include "palpate/math3.hpp"

#include <cmath>

namespace palpate::runtime {

/// The sideways forces of a separable response add without regard to each other and to the depth, so on a closed way of
/// a tool that sticks they may give more than they took, and what a straight push's sideways force holds comes and goes
/// with the depth. So the work that the hand does sideways is counted, over trapezoids. Of what it gave the strain
/// holds no more than force times deflection, which a force that is constant would store: the rest is lost. What it
/// gets beyond that is the contact's to owe (EnergyAccount).
class StrainTally {
public:
  /// A contact begins, without force.
  void reset() { *this = StrainTally(); }

  /// The tool's motion took the sideways deflection to so much (m).
  void move(const Vec3& aside) { moved_ = aside; }
  /// After that its anchor went so that `aside` (m) is left. There the sideways force is `pull` (N), the straight
  /// push's holds `lean` (J), and the deflection's at most `most` (J). Returns J, at least 0, that the hand got and had
  /// not given.
  [[nodiscard]] double add(const Vec3& aside, const Vec3& pull, double lean, double most) {
    const double given = given_ - 0.5 * dot(pull_ + pull, moved_ - aside_) - (lean - lean_);
    given_ = std::fmax(0, given);
    keep(aside, pull, lean, most);
    return given < 0 ? -given : 0;
  }

  /// The contact changed while the tool stood still, by so much (m, J): no work of the hand.
  void shift(const Vec3& aside, double lean) {
    aside_ = aside_ + aside;
    lean_ += lean;
  }
  /// Friction left this share of what the deflection holds. Returns J of the hand's that it took.
  double rub(double share) {
    const double before = given_;
    given_ *= std::fmin(1, share);
    return before - given_;
  }
  /// This is there now, as in add().
  void keep(const Vec3& aside, const Vec3& pull, double lean, double most) {
    given_ = std::fmin(given_, most);
    aside_ = aside;
    pull_ = pull;
    lean_ = lean;
  }

  /// Newtons are `ratio` (above 0) times as large from now on.
  void rescale(double ratio) {
    given_ /= ratio;
    pull_ = (1 / ratio) * pull_;
    lean_ /= ratio;
  }
  void rotate(const Pose& by) {
    aside_ = by.rotate(aside_);
    pull_ = by.rotate(pull_);
  }

private:
  double given_ = 0;  ///< J, by the hand and held by the deflection
  Vec3 moved_;        ///< m, by this tick's motion
  Vec3 aside_;        ///< m, of the last tick
  Vec3 pull_;         ///< N
  double lean_ = 0;   ///< J
};

}  // namespace palpate::runtime
