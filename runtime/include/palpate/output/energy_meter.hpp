// SPDX-License-Identifier: MIT
// Work of the hand on a contact, for display and tests.
#pragma once

#include "palpate/contact/tick.hpp"
#include "palpate/math/rotation.hpp"

#include <cmath>

namespace palpate::runtime {

/// Sums the work of the hand on one contact by the trapezoidal rule, translation and rotation. Call add() in every
/// tick.
class EnergyMeter {
public:
  void reset() { *this = EnergyMeter(); }

  /// Adds the work from the last tick to this tick. `pose`: of the tool, in the frame of the tick. A pose that is not
  /// valid ends the path; the sums stay.
  void add(const Pose& pose, const Tick& tick) {
    if (!pose.valid()) {
      started_ = false;
      return;
    }
    if (started_) {
      const Vec3 rotation = small_rotation(pose * inverse(pose_));
      const double work = -0.5 * (dot(tick_.force + tick.force, pose.translation - pose_.translation) +
                                  dot(tick_.torque + tick.torque, rotation));
      (work > 0 ? given_ : returned_) += std::fabs(work);
    }
    pose_ = pose;
    tick_ = tick;
    started_ = true;
  }

  [[nodiscard]] double given() const { return given_; }        ///< J, work of the hand on the contact
  [[nodiscard]] double returned() const { return returned_; }  ///< J, work of the contact on the hand
  /// J, dissipated in the contact. `held` (J): energy in it, contact.state().energy.energy().
  [[nodiscard]] double dissipated(double held) const { return given_ - returned_ - held; }

private:
  bool started_ = false;
  Pose pose_;  ///< last
  Tick tick_;  ///< last
  double given_ = 0, returned_ = 0;
};

}  // namespace palpate::runtime
