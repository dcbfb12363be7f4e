// SPDX-License-Identifier: MIT
// What a contact owes of what it stores, and what went through the hand.
#pragma once

#include "palpate/tick.hpp"

#include <cmath>

namespace palpate::runtime {

/// A contact whose field is replaced (c goes on over a body that is harder elsewhere, the tool tilts, factors change)
/// may store more than the hand gave, and sideways forces that are no gradient may give back more (StrainTally): the
/// difference is owed. It is not taken from the force, which stays the place's own, but from what comes back: a lift
/// loses of the stored energy in the same proportion as is owed, so the force falls sooner than it rose, without a
/// step, and is zero where nothing of what the hand gave is left. More than half of what is stored is not owed for
/// long: beyond that the depth is held back. All losses follow motions: a hand at rest feels none.
class EnergyAccount {
public:
  void reset() { owed_ = lost_ = 0; }

  /// Stored energy (J) before and after the field was replaced at one pose; returns what of it is to be lost at once.
  /// With `friction` a loss pays what is owed but buys nothing; so does what was `rubbed` (J) besides. Where that is
  /// negative the hand got it, or gave so much less than `before` tells.
  double replaced(double before, double after, bool friction, double rubbed) {
    const double change = after - before, more = rubbed < 0 ? change - rubbed : change;
    stored_ = owed_ > 0 ? stored_ + change : after;  // what the motion of this tick changed is still to be told
    const double least = friction ? std::fmin(owed_, 0.0) : owed_ + more;
    owed_ = std::fmax(owed_ + more, least);
    if (rubbed > 0 && owed_ > 0) owed_ = std::fmax(0.0, owed_ - rubbed);
    return too_much(after, more);
  }

  /// Friction took `taken` (J) on the way of a part that slipped, of what the hand gave; what is stored (J) is another
  /// after that than if it had been stretched all the way first. While something is owed.
  void rubbed(double before, double after, double taken) {
    stored_ += after - before;
    owed_ = std::fmax(0.0, owed_ - std::fmin(taken, before - after));
  }

  /// J, of which `more` are owed since the last tick, while `stored` (J) is stored, less than nothing where the tool
  /// went with a straight push's sideways force: what is to be lost at once. Nothing of so little as c stores by
  /// creeping on while the hand rests, though it is owed.
  [[nodiscard]] double too_much(double stored, double more) const {
    constexpr double kCreep = 1e-7;
    const double all = std::fabs(stored);
    return more > kCreep * all ? std::fmax(0, std::fmin(2 * owed_ - all, 2 * more)) : 0;
  }

  /// The hand got, or did not give, so much (J) of what is stored.
  void owe(double more) {
    if (!(owed_ > 0)) stored_ = 0;  // to be told
    owed_ += more;
  }

  /// Joules are `ratio` (above 0, infinite where there were none) times as large from now on.
  void rescale(double ratio) {
    owed_ /= ratio;
    stored_ /= ratio;
  }

  /// J, negative where the hand has given more than is stored.
  [[nodiscard]] double owed() const { return owed_; }

  /// J to lose on a motion after which `stored` would be left.
  [[nodiscard]] double due(double stored) const {
    constexpr double kMostShare = 2;  // the force falls at most three times as fast as the tool's lift asks
    if (!(stored < stored_ && stored_ > 0) || !(owed_ > 0)) return 0;
    const double share = owed_ < kMostShare * (stored_ - owed_) ? owed_ / (stored_ - owed_) : kMostShare;
    return std::fmin(share * (stored_ - stored), owed_);
  }

  /// What the motion of this tick changed was told, and `stored` (J) is what it left.
  void told(double stored) { stored_ = stored; }
  /// After `lost` (J) of it was paid; `stored` is left.
  void paid(double lost, double stored) {
    lose(lost);
    stored_ = stored;
  }
  /// After `lost` (J) were lost at once. What the motion of this tick changed may still be to be told.
  void held_back(double lost) {
    lose(lost);
    stored_ -= lost;
  }

  /// J, all that was paid.
  [[nodiscard]] double lost() const { return lost_; }

private:
  void lose(double lost) {
    owed_ -= lost;
    lost_ += lost;
  }

  double owed_ = 0;    ///< J
  double stored_ = 0;  ///< J, in the last tick; kept while something is owed
  double lost_ = 0;    ///< J
};

/// Counts the work of the hand on one contact, for a program that wants to see it: add every tick with its pose. Work
/// is summed over trapezoids.
class EnergyMeter {
public:
  void reset() { *this = EnergyMeter(); }

  void add(const Pose& pose, const Tick& tick) {
    if (!pose.valid()) return reset_last();
    const Vec3 turn = started_ ? small_turn(pose * inverse(last_pose_)) : Vec3{};
    const double work = started_ ? -0.5 * (dot(last_.force + tick.force, pose.translation - last_pose_.translation) +
                                           dot(last_.torque + tick.torque, turn))
                                 : 0;
    (work > 0 ? given_ : returned_) += std::fabs(work);
    last_pose_ = pose;
    last_ = tick;
    started_ = true;
  }

  /// J, of the hand on the body, and of the body on the hand.
  [[nodiscard]] double given() const { return given_; }
  [[nodiscard]] double returned() const { return returned_; }
  /// J, with what the hand gave of what the contact holds now (Contact::stored less Contact::owed).
  [[nodiscard]] double dissipated(double held) const { return given_ - returned_ - held; }

private:
  void reset_last() { started_ = false; }

  Pose last_pose_;
  Tick last_;
  bool started_ = false;
  double given_ = 0, returned_ = 0;
};

}  // namespace palpate::runtime
