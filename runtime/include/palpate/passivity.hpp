// SPDX-License-Identifier: MIT
// Time-domain passivity of a force loop: watches the energy that sampling, hold and delay make, and takes back
// stiffness.
#pragma once

#include "palpate/math3.hpp"

#include <cmath>

namespace palpate::runtime::output {

/// What the observer knows of the device, in its frame. What is not known is 0: then more is taken for made. With
/// neither damping nor friction all that a press makes counts until the pause after it.
struct PassivityOptions {
  double delay = 0;      ///< s, from an encoder through the loop to the motor; [0, 0.02]
  double damping = 0;    ///< N s/m, viscous, that the device has at least; at least 0
  double friction = 0;   ///< N, Coulomb, that the device has at least; at least 0
  double stiffness = 0;  ///< N/m, of the stiffest contact, where it is known beforehand; at least 0
  double trace = 5e-5;   ///< J, that may have been given out beyond what went in; above 0
  double pause = 0.5;    ///< s without force in which a hand loses what it was given; at least 0.1, infinite: never

  /// Null, or what is wrong.
  [[nodiscard]] const char* validate() const {
    if (!(delay >= 0 && delay <= 0.02)) return "the device's delay is outside 0 to 0.02 s";
    if (!(damping >= 0 && damping < 1e6)) return "the device's damping is outside 0 to 1e6 N s/m";
    if (!(friction >= 0 && friction < 1e6)) return "the device's friction is outside 0 to 1e6 N";
    if (!(stiffness >= 0 && stiffness < 1e12)) return "the contact's stiffness is outside 0 to 1e12 N/m";
    if (!(trace > 0 && trace < 1e6)) return "the passivity controller's trace is outside 0 to 1e6 J";
    if (!(pause >= 0.1)) return "the passivity controller's pause is below 0.1 s";
    return nullptr;
  }
};

/// Passivity observer and controller; the last step of an Output, for it must see what is sent.
///
/// The observer (Hannaford and Ryu 2002; with the energy that the model itself would show as its reference, Ryu et al.
/// 2005) adds up what the motors gave out between two samples beyond what the contact would have on the same way
/// without sampling: (force that acted - mean of the forces at both ends) . motion. A passive contact gives out nothing
/// on a closed way, so the sum bounds what sampling, hold and delay have made. From it goes what the device surely
/// turns to heat, friction |motion| + damping |motion|^2 / time; it is at least 0, so nothing is saved up.
///
/// The controller does not add damping, which would be as late as the force that it has to mend: it lets the force be a
/// smaller share of the contact's, 1 - made / trace, but no smaller than what makes the stiffest secant so far passive
/// for any hand: 2 damping / (delay + T (1 + ceil(delay / T))) over that slope, T the time between samples (Colgate and
/// Schenkel 1997, with a delay; device/stability.hpp). Within a contact the share only falls, which takes energy out;
/// without force it rises again to what the energy still made allows.
///
/// Of a device without known damping and friction nothing is sure to take that energy, and no stiffness is passive for
/// any hand: presses add up until next to no force is left, for good. But a hand does not keep what it was given. Left
/// without force it turns that to heat in a few times its mass over its damping (0.1 s for 0.3 kg and 3 N s/m, with the
/// handle), so after a pause the observer begins anew. Shorter ones count for nothing, else a handle that bounces off a
/// wall would be given the trace each time. What follows holds from one pause to the next; with an infinite one for all
/// time, in any hand or in none.
///
/// So what is made stays below trace + 2 F W, as far as the steepest slope is known or was met: what was sent before
/// the trace was reached still acts for a delay, and is seen up to two ticks later; in that time the handle goes no
/// farther than W, against two forces (the one that acts, the contact's) no stronger than F each. Forces on their way
/// cannot be recalled, and foreseeing what they will do from the motion so far does not bound it
/// (tests/device/stability.md). Where more than 240 forces are on their way it counts by means of some, and for the
/// rest as if each had been the worst of them. Beforehand F is the device's peak force, and W the fastest motion to be
/// reckoned with times delay + 2 T.
class Passivity {
public:
  explicit Passivity(const PassivityOptions& options) : options_(options), slope_(options.stiffness) {}

  /// Force (N) of the contact at a position (m) that the loop sees, `seconds` after the last one.
  Vec3 operator()(const Vec3& force, double seconds, const Vec3& position) {
    time_ += seconds;
    close();
    if (started_) observe(force, seconds, position - position_);
    started_ = true;
    idle_ = dot(force, force) > 0 ? 0 : idle_ + seconds;
    if (idle_ > 0) share_ = 1;
    if (idle_ >= options_.pause) made_ = 0;
    share_ = std::fmin(share_, std::fmax(1 - made_ / options_.trace, passive_share(seconds)));
    position_ = position;
    contact_ = force;
    send(share_ * force, seconds);
    return share_ * force;
  }

  /// Of its options.
  [[nodiscard]] const char* validate() const { return options_.validate(); }

  /// As if nothing had been sent or made.
  void reset() { *this = Passivity(options_); }

  [[nodiscard]] double made() const { return made_; }  ///< J, energy made that the device has not turned to heat
  /// J, trace + 2 F W: what was made stays below it.
  [[nodiscard]] double bound() const { return options_.trace + 2 * strongest_ * farthest_; }
  [[nodiscard]] double share() const { return share_; }  ///< of the contact's force that is sent, [0, 1]

private:
  /// A force that was sent, until the next one was; or the mean of several.
  struct Sent {
    double time = -HUGE_VAL;
    Vec3 force;
    double off = 0;  ///< N, that any of them lies off the mean at most
    double way = 0;  ///< m, that the handle had gone by then
  };

  /// A delay is never more than kMost entries: what is sent sooner after one is taken into it, so that of a fast loop
  /// the forces of the whole delay are there.
  void send(const Vec3& force, double seconds) {
    sending_ = force;
    since_ = time_;
    strongest_ = std::fmax(strongest_, length(force));
    if (time_ - sent_[newest_].time >= options_.delay / kMost) {
      newest_ = next(newest_);
      sent_[newest_] = {time_, force, 0, way_};
      if (oldest_ == newest_) oldest_ = next(oldest_);
    }
    const double from = time_ - (options_.delay + 2 * seconds) * (1 + 1e-9);
    // Of a time that stands still by its rounding all may be that old.
    while (oldest_ != newest_ && sent_[next(oldest_)].time <= from) oldest_ = next(oldest_);
    farthest_ = std::fmax(farthest_, way_ - sent_[oldest_].way);
  }

  /// The force that was sent last has acted as long as it will.
  void close() {
    Sent& last = sent_[newest_];
    if (!(since_ > last.time)) {  // the first of its entry
      last.force = sending_;
      last.off = 0;
      return;
    }
    const Vec3 mean = last.force + ((time_ - since_) / (time_ - last.time)) * (sending_ - last.force);
    last.off = std::fmax(last.off + length(mean - last.force), length(mean - sending_));
    last.force = mean;
  }

  void observe(const Vec3& force, double seconds, const Vec3& motion) {
    const Vec3 without = 0.5 * share_ * (contact_ + force);
    const double heat = options_.friction * length(motion) + options_.damping * dot(motion, motion) / seconds;
    made_ = std::fmax(0, made_ + given(seconds, motion) - dot(without, motion) - heat);
    const double way = length(motion);
    way_ += way;
    if (way > 0) slope_ = std::fmax(slope_, length(force - contact_) / way);
  }

  /// Share of the force with which the contact, as stiff as it has been, makes nothing.
  [[nodiscard]] double passive_share(double seconds) const {
    if (!(slope_ > 0)) return 0;
    const double late = options_.delay + seconds * (1 + std::ceil(options_.delay / seconds * (1 - 1e-12)));
    return std::fmin(1, 2 * options_.damping / (late * slope_));
  }

  /// J at most, that the motors gave out since the last sample: by the forces sent a delay before.
  [[nodiscard]] double given(double seconds, const Vec3& motion) const {
    const double from = time_ - seconds - options_.delay, end = time_ - options_.delay, way = length(motion);
    double to = end, sum = 0;
    int k = newest_;
    for (int count = 0; count < kSent; ++count, k = (k + kSent - 1) % kSent) {
      const double begin = std::fmax(sent_[k].time, from);
      // A time below what its sum resolves is all of one force.
      const double share = end > from ? (to - begin) / (end - from) : begin <= to ? 1 : 0;
      if (!(share > 0)) continue;
      sum += share * (dot(sent_[k].force, motion) + sent_[k].off * way);
      to = begin;
      if (!(to > from)) break;
    }
    return std::fmin(sum, strongest_ * way);
  }

  static constexpr int kSent = 256, kMost = 240;
  static int next(int k) { return (k + 1) % kSent; }

  PassivityOptions options_;
  bool started_ = false;
  double time_ = 0, made_ = 0, share_ = 1;
  double idle_ = 0;  ///< s, without force so far
  double slope_;     ///< N/m, steepest secant of force over motion so far
  Vec3 position_, contact_;
  double way_ = 0, farthest_ = 0;  ///< m, gone; the longest way within a delay and two ticks
  double strongest_ = 0;           ///< N, that was sent
  Vec3 sending_;                   ///< N
  double since_ = -HUGE_VAL;       ///< s, when that was sent
  Sent sent_[kSent];
  int newest_ = 0, oldest_ = 0;  ///< the oldest of that delay and those ticks
};

}  // namespace palpate::runtime::output
