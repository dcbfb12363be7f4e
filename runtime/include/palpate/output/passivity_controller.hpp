// SPDX-License-Identifier: MIT
// Time-domain passivity: observes the energy that sampling, hold and delay generate, and reduces the stiffness.
#pragma once

#include "palpate/math/vec3.hpp"

#include <cmath>

namespace palpate::runtime::output {

/// Properties of the device, in its frame. Unknown properties are 0, which is the safe side. Without damping and
/// friction all generated energy counts until the next pause.
struct PassivityOptions {
  double delay = 0;      ///< s, [0, 0.02]: from the encoder through the loop to the motor
  double damping = 0;    ///< N s/m, [0, 1e6): lower bound of the device's viscous damping
  double friction = 0;   ///< N, [0, 1e6): lower bound of the device's Coulomb friction
  double stiffness = 0;  ///< N/m, [0, 1e12): of the stiffest contact, 0 where unknown
  double trace = 5e-5;   ///< J, (0, 1e6): generated energy at which the force would be zero
  double pause = 0.5;    ///< s, [0.1, inf]: time without force after which the generated energy is dissipated

  /// Returns null, or the option that is out of range.
  [[nodiscard]] const char* validate() const {
    if (!(delay >= 0 && delay <= 0.02)) return "delay of the passivity controller is outside [0, 0.02] s";
    if (!(damping >= 0 && damping < 1e6)) return "damping of the passivity controller is outside [0, 1e6) N s/m";
    if (!(friction >= 0 && friction < 1e6)) return "friction of the passivity controller is outside [0, 1e6) N";
    if (!(stiffness >= 0 && stiffness < 1e12)) return "stiffness of the passivity controller is outside [0, 1e12) N/m";
    if (!(trace > 0 && trace < 1e6)) return "trace of the passivity controller is outside (0, 1e6) J";
    if (!(pause >= 0.1)) return "pause of the passivity controller is outside [0.1, inf] s";
    return nullptr;
  }
};

/// The forces that were sent within the last delay. Loops with more than 240 forces in a delay keep means of neighbours
/// with their largest deviation.
class SentForces {
public:
  /// Ends the time (s) in which the last force was the newest.
  void advance(double seconds) {
    time_ += seconds;
    Entry& newest = entries_[newest_];
    if (!(sent_at_ > newest.time)) {  // the first force of its entry
      newest.force = force_;
      return;
    }
    const double share = (time_ - sent_at_) / (time_ - newest.time);
    const Vec3 mean = newest.force + share * (force_ - newest.force);
    newest.deviation = std::fmax(newest.deviation + length(mean - newest.force), length(mean - force_));
    newest.force = mean;
  }

  /// Adds to the path of the handle (m).
  void travel(double way) { path_ += way; }

  /// Returns an upper bound of the motors' work (J) on a motion (m) that took `seconds` until now. The motors applied
  /// the forces that were sent a delay (s) before.
  [[nodiscard]] double work(double seconds, double delay, const Vec3& motion) const {
    const double from = time_ - seconds - delay, end = time_ - delay, way = length(motion);
    double to = end, sum = 0;
    int k = newest_;
    for (int count = 0; count < kEntries; ++count, k = (k + kEntries - 1) % kEntries) {
      const double begin = std::fmax(entries_[k].time, from);
      // A time below the resolution of time_ belongs to one force.
      const double share = end > from ? (to - begin) / (end - from) : begin <= to ? 1 : 0;
      if (!(share > 0)) continue;
      sum += share * (dot(entries_[k].force, motion) + entries_[k].deviation * way);
      to = begin;
      if (!(to > from)) break;
    }
    return std::fmin(sum, strongest_ * way);
  }

  /// Adds a force (N) that is sent now.
  void send(const Vec3& force, double seconds, double delay) {
    force_ = force;
    sent_at_ = time_;
    strongest_ = std::fmax(strongest_, length(force));
    if (time_ - entries_[newest_].time >= delay / kEntriesOfDelay) {
      newest_ = next(newest_);
      entries_[newest_] = {time_, force, 0, path_};
      if (oldest_ == newest_) oldest_ = next(oldest_);
    }
    const double from = time_ - (delay + 2 * seconds) * (1 + 1e-9);
    while (oldest_ != newest_ && entries_[next(oldest_)].time <= from) oldest_ = next(oldest_);
    longest_path_ = std::fmax(longest_path_, path_ - entries_[oldest_].path);
  }

  [[nodiscard]] double strongest() const { return strongest_; }        ///< N, F
  [[nodiscard]] double longest_path() const { return longest_path_; }  ///< m, W: longest path in a delay and two ticks

private:
  /// A force, or the mean of several neighbours.
  struct Entry {
    double time = -HUGE_VAL;  ///< s, when the first was sent
    Vec3 force;               ///< N, mean over time
    double deviation = 0;     ///< N, largest distance of any of them from the mean
    double path = 0;          ///< m, of the handle until then
  };
  /// A delay has at most kEntriesOfDelay entries, so that the buffer holds a delay and two ticks of any loop.
  static constexpr int kEntries = 256, kEntriesOfDelay = 240;
  static int next(int k) { return (k + 1) % kEntries; }

  Entry entries_[kEntries];
  int newest_ = 0, oldest_ = 0;  ///< the oldest within a delay and two ticks
  double time_ = 0;              ///< s
  Vec3 force_;                   ///< N, the last that was sent
  double sent_at_ = -HUGE_VAL;   ///< s
  double strongest_ = 0;         ///< N
  double path_ = 0;              ///< m
  double longest_path_ = 0;      ///< m
};

/// Passivity observer and controller, the last step of an OutputChain. The observer (Hannaford and Ryu 2002; Ryu and
/// others 2005) sums the energy E (J) that the motors give out beyond the contact's own work, less the device's heat:
///
///     E += f_motor . dx - share (f_last + f) / 2 . dx - friction |dx| - damping |dx|^2 / T,     E >= 0
///
///     f_motor  mean force of the motors on dx (N)     f, f_last  the contact's forces at the ends of dx (N)
///     dx       motion between two samples (m)         T          time between them (s)
///
/// A passive contact gives out no work on a closed path, so E bounds the energy of sampling, hold and delay. The
/// controller multiplies the contact's force by
///
///     share = max(1 - E / trace, 2 damping / ((delay + T (1 + ceil(delay / T))) k)),    in [0, 1]
///
/// with k (N/m) the steepest secant of force over motion so far. The second value is passive for every hand (Colgate
/// and Schenkel 1997, with a delay; device/stability/stability.hpp). The share only falls within a contact, which
/// removes energy. Added damping would be as late as the forces that it corrects.
///
/// After `pause` seconds without force E is 0, because hand and handle have dissipated it (in a few times 0.1 s for
/// 0.3 kg and 3 N s/m). Shorter times count for nothing, because a bouncing handle would get the trace at each touch.
///
/// Bound: E <= trace + 2 F W between two pauses, if k was met or stated before (tests/device/stability/stability.md). F
/// (N) is the largest force, W (m) the longest path of the handle in a delay and two ticks. Sent forces cannot be
/// recalled.
class PassivityController {
public:
  explicit PassivityController(const PassivityOptions& options) : options_(options), slope_(options.stiffness) {}

  /// Returns the force (N) to send for a contact's force at a position (m), `seconds` after the last call.
  Vec3 operator()(const Vec3& force, double seconds, const Vec3& position) {
    sent_.advance(seconds);
    if (started_) observe(force, seconds, position - position_);
    started_ = true;
    idle_ = dot(force, force) > 0 ? 0 : idle_ + seconds;
    if (idle_ > 0) share_ = 1;
    if (idle_ >= options_.pause) made_ = 0;
    share_ = std::fmin(share_, std::fmax(1 - made_ / options_.trace, passive_share(seconds)));
    position_ = position;
    contact_ = force;
    sent_.send(share_ * force, seconds, options_.delay);
    return share_ * force;
  }

  [[nodiscard]] const char* validate() const { return options_.validate(); }
  /// Forgets all forces and energies.
  void reset() { *this = PassivityController(options_); }

  [[nodiscard]] double made() const { return made_; }    ///< J, E
  [[nodiscard]] double share() const { return share_; }  ///< [0, 1], of the contact's force that is sent
  /// J, trace + 2 F W: upper bound of made().
  [[nodiscard]] double bound() const { return options_.trace + 2 * sent_.strongest() * sent_.longest_path(); }

private:
  void observe(const Vec3& force, double seconds, const Vec3& motion) {
    const Vec3 mean = 0.5 * share_ * (contact_ + force);
    const double way = length(motion);
    const double heat = options_.friction * way + options_.damping * dot(motion, motion) / seconds;
    made_ = std::fmax(0, made_ + sent_.work(seconds, options_.delay, motion) - dot(mean, motion) - heat);
    sent_.travel(way);
    if (way > 0) slope_ = std::fmax(slope_, length(force - contact_) / way);
  }

  /// Largest share that is passive for every hand.
  [[nodiscard]] double passive_share(double seconds) const {
    if (!(slope_ > 0)) return 0;
    constexpr double kWholeTicks = 1 - 1e-12;  // a delay of n ticks counts as n in spite of rounding
    const double late = options_.delay + seconds * (1 + std::ceil(options_.delay / seconds * kWholeTicks));
    return std::fmin(1, 2 * options_.damping / (late * slope_));
  }

  PassivityOptions options_;
  SentForces sent_;
  bool started_ = false;
  double made_ = 0;  ///< J
  double share_ = 1;
  double idle_ = 0;          ///< s, without force until now
  double slope_;             ///< N/m, k
  Vec3 position_, contact_;  ///< m and N, of the last call
};

}  // namespace palpate::runtime::output
