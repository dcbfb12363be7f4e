// SPDX-License-Identifier: MIT
// A virtual coupling: the tool that the body meets hangs on the device by a spring and a damper.
#pragma once

#include "palpate/tick.hpp"

#include <cmath>

namespace palpate::runtime {

/// The tool is the device: no coupling, and nothing of it in the program.
struct Rigid {
  template <class Contact, class... More>
  auto tick(Contact& contact, const Pose& device, double /*seconds*/, const More&... more) const {
    return contact.tick(device, more...);
  }
  void reset() {}
};

struct CouplingOptions {
  double stiffness = 500;  ///< N/m, (0, 1e12]: no contact feels stiffer
  double damping = 0;      ///< N s/m, [0, 1e9]; it asks for as much more damping of the device (device/stability.hpp)
  int trials = 8;          ///< [2, 64]: ticks of the contact in one tick before the balance is given up

  /// Null, or what is wrong.
  [[nodiscard]] const char* validate() const {
    if (!(stiffness > 0 && stiffness <= 1e12)) return "the coupling's stiffness is outside 0 to 1e12 N/m";
    if (!(damping >= 0 && damping <= 1e9)) return "the coupling's damping is outside 0 to 1e9 N s/m";
    if (!(trials >= 2 && trials <= 64)) return "the coupling's trials are outside 2 to 64";
    return nullptr;
  }
};

/// A tool without mass between device and contact (Colgate, Stanley and Brown 1995; Adams and Hannaford 1999): in every
/// tick it is where the contact's force on it and the coupling's are in balance,
///
///     F(x) = K s + B (s - s_last) / T,    s = x - device,
///
/// and the hand feels the coupling's side. The damper is taken by the implicit step of Euler, with which spring and
/// damper store or turn to heat all that comes in over both sides, forces at the end of a tick times motions within it:
/// K s . ds is at least the change of K s^2 / 2. So the coupling is passive for any motion and any time between ticks,
/// and hides none of the contact's passivity. Without a damper what the hand feels is the contact's Moreau-Yosida
/// regularisation (Moreau 1965): of a contact that pushes back the more the deeper it is, whatever its slope k, one
/// with the slope K k / (K + k) < K. (A tool that slips off an edge snaps round it.) Without contact the force is
/// exactly zero; the tool is at the device, or with a damper comes back to it. The tool turns with the device, and the
/// torque is the contact's.
///
/// The balance is sought by ticks from one state of the contact, of which only the last remains (a copy of the contact
/// is on the stack meanwhile). A quasi-Newton step (Broyden 1965) with the slope that earlier ticks taught is mostly
/// right at once. It holds to 0.1 % of the force and 1e-5 of a contact's size. What that leaves is work that nobody
/// did; it is counted with what the damper and the implicit step lose, which it must not exceed.
///
/// Nor is the contact trusted: a tool without mass slides as fast as the ticks let it, and what is passive in small
/// steps need not be in one of half a contact's size (round a coarse body without friction it drew 67 mJ in 2 s, which
/// the hand got). The work that a contact does on the tool, by the coupling's force and its torque, as a sum over
/// trapezoids since it began to touch, must not exceed 1 % of the most that it took. So without a damper neither does
/// the hand get more than that from a touch, but for half the force along its first and its last tick's motion.
///
/// Where either would be exceeded, and where `trials` ticks find no balance (a force that jumps has none), the tool
/// stops where it came nearest to one, or stays where it was if even that would give energy out. The hand always feels
/// the spring and damper between it and the tool, and nothing else. So it may be held for a tick by a tool that just
/// left the body: such a tick says stick, without torque, depth and limit, at the points where the tool touched last.
/// One that says free or released has no force.
class VirtualCoupling {
public:
  static constexpr int kRepeats = 8;  ///< as an Output's

  /// With options that are not valid every tick is a fault.
  explicit VirtualCoupling(const CouplingOptions& options)
      : options_(options), usable_(options.validate() == nullptr) {}

  /// Force of `contact` on the hand that holds the device (pose in the body's frame), `seconds` (above 0) after the
  /// last tick. The rest of the tick is of the tool. A pose that is none, or no time, is a fault that forgets all. But
  /// a time of 0 (a sample that came twice) gives the last tick once more, kRepeats times in a row, as an Output does.
  /// The contact: a BasicContact, or what can be copied, has a size() and ticks like one, ContactsAsOne or an
  /// AnimatedContact. What else its tick asks for comes last: a Search, or the seconds of an AdjustedContact, which are
  /// these. For a body that moves rigidly see MovingContact.
  template <class Contact, class... More>
  Tick tick(Contact& contact, const Pose& device, double seconds, const More&... more) {
    if (usable_ && seconds == 0 && device.valid() && repeated_ < kRepeats) {
      ++repeated_;
      return given_;
    }
    if (!(usable_ && seconds > 0 && std::isfinite(seconds)) || !device.valid()) return fault(contact);
    repeated_ = 0;
    const double size = contact.size();
    if (started_) go_along(contact, 0);
    // A device that leaps did not move, as a tool that does.
    if (touching_ && length(device.translation - device_) > size) {
      contact.reset();
      started_ = touching_ = false;
      given_ = {};
    }
    begin(device, seconds, size);
    const Contact before = contact;
    Pose pose = device;
    Tick tick, touched = given_;
    const auto at = [&](const Vec3& tool) {
      if (trials_++ > 0) contact = before;
      pose.translation = tool;
      tick = contact.tick(pose, more...);
      if (tick.touches()) touched = tick;
      return weigh(tool, tick.force, tick.torque);
    };
    Trial now = at(first());
    while (tick.state != State::fault && !accept(now) && trials_ < options_.trials) now = at(next(now));
    if (tick.state == State::fault) return fault(contact);
    if (!balanced_) {
      const Vec3 kept = exact_ && pays(base_) ? base_.tool : tool_;
      if (length(kept - now.tool) > 0) now = at(kept);
      keep(now);
    }
    if (touching_ && !tick.touches()) {
      tick = touched;
      tick.state = State::stick;
      tick.torque = {};
      tick.depth = tick.friction_limit = tick.covered = 0;
      tick.beyond = false;
    }
    tick.force = felt_;
    given_ = tick;
    return tick;
  }

  /// Of its options.
  [[nodiscard]] const char* validate() const { return options_.validate(); }

  /// As if the tool had always been at the device, and free.
  void reset() { *this = VirtualCoupling(options_); }

  [[nodiscard]] const CouplingOptions& options() const { return options_; }
  [[nodiscard]] const Vec3& tool() const { return tool_; }                                    ///< m, body frame
  [[nodiscard]] double stored() const { return 0.5 * options_.stiffness * dot(lag_, lag_); }  ///< J
  [[nodiscard]] double lost() const { return lost_; }                                         ///< J, never below 0
  [[nodiscard]] int trials() const { return trials_; }       ///< ticks of the contact in the last tick
  [[nodiscard]] bool balanced() const { return balanced_; }  ///< the last tick found its balance

private:
  struct Trial {
    Vec3 tool;    ///< m
    Vec3 force;   ///< N, the contact's there
    Vec3 left;    ///< N, of it beyond the coupling's
    Vec3 torque;  ///< N m, the contact's
    [[nodiscard]] bool pushes() const { return dot(force, force) > 0; }
  };

  template <class Contact>
  Tick fault(Contact& contact) {
    contact.reset();
    reset();
    repeated_ = kRepeats;  // a clock that stands still goes on being one
    Tick tick;
    tick.state = State::fault;
    return tick;
  }

  /// What pushes a tool as it moves does work that is no gain from nothing: all is told as if the body had not moved.
  template <class Contact>
  auto go_along(const Contact& contact, int) -> decltype(contact.moved(), void()) {
    const Pose by = contact.moved();
    for (Vec3* point : {&device_, &tool_, &given_.body_point, &given_.tool_point}) *point = by.apply(*point);
    for (Vec3* way : {&lag_, &force_, &felt_, &torque_}) *way = by.rotate(*way);
    pose_ = by * pose_;
  }
  template <class Contact>
  void go_along(const Contact& /*contact*/, long /*stands still*/) {}

  void begin(const Pose& device, double seconds, double size) {
    if (!started_) {
      tool_ = device.translation;
      lag_ = force_ = felt_ = torque_ = {};
      gained_ = taken_ = 0;
      started_ = true;
    } else if (touching_) {
      turn_ = small_turn(device * inverse(pose_));
    }
    if (!touching_) turn_ = {};
    pose_ = device;
    device_ = device.translation;
    damper_ = options_.damping / seconds;
    stiff_ = options_.stiffness + damper_;
    goal_ = device_ + (damper_ / stiff_) * lag_;
    leap_ = touching_ ? 0.5 * size : HUGE_VAL;
    way_out_ = within(goal_);
    near_ = 1e-5 * size;
    noise_ = 1e-15 * stiff_ * (length(goal_) + size);
    shorter_ = 1;
    trials_ = 0;
    balanced_ = exact_ = been_out_ = false;
    base_ = weigh(tool_, force_, torque_);
  }

  [[nodiscard]] Trial weigh(const Vec3& tool, const Vec3& force, const Vec3& torque) const {
    return {tool, force, force - stiff_ * (tool - goal_), torque};
  }

  /// A touching tool does not leap: beyond a contact's size it would count as put elsewhere.
  [[nodiscard]] Vec3 within(const Vec3& tool) const {
    const Vec3 way = tool - tool_;
    const double size = length(way);
    return size > leap_ ? tool_ + (leap_ / size) * way : tool;
  }

  /// A free tool is where it would be without contact, if it stays free.
  [[nodiscard]] Vec3 first() const { return touching_ ? within(tool_ + step(base_.left)) : goal_; }

  /// Whether the tool stays there. Without force on the way out it is free, and goes where the coupling wants it.
  bool accept(Trial& now) {
    constexpr double kShare = 1e-3;
    const bool out = !(length(now.tool - way_out_) > 0);
    been_out_ = been_out_ || out;
    if (now.pushes()) learn(now);
    if (out && !now.pushes()) {
      now = {goal_, {}, {}, {}};
    } else if (!(length(now.left) <= kShare * length(now.force) + near_ * std::fmin(stiff_, slope()) + noise_) ||
               !pays(now)) {
      return false;
    }
    balanced_ = true;
    keep(now);
    return true;
  }

  /// J lost in this tick with the tool there: what came in over both sides less what is stored more.
  [[nodiscard]] double loss(const Trial& now) const {
    const Vec3 change = now.tool - device_ - lag_;
    return (0.5 * options_.stiffness + damper_) * dot(change, change) + dot(now.left, now.tool - tool_);
  }

  /// J that the contact does on the tool in this tick, by what the coupling holds it with, and its torque.
  [[nodiscard]] double gain(const Trial& now) const {
    return 0.5 * (dot(felt_ + stiff_ * (now.tool - goal_), now.tool - tool_) + dot(torque_ + now.torque, turn_));
  }

  /// Whether neither side gives out energy that it has not: the coupling what it lost, the contact what it took.
  [[nodiscard]] bool pays(const Trial& now) const {
    constexpr double kShare = 0.01;
    const double more = gain(now);
    return lost_ + loss(now) >= -noise_ * length(now.tool - tool_) &&
           (!touching_ || !(more > 0) || gained_ + more <= kShare * taken_);
  }

  void keep(const Trial& now) {
    lost_ = std::fmax(0, lost_ + loss(now));
    gained_ += gain(now);
    taken_ = std::fmax(taken_, -gained_);
    felt_ = stiff_ * (now.tool - goal_);
    tool_ = now.tool;
    force_ = now.force;
    torque_ = now.torque;
    lag_ = tool_ - device_;
    touching_ = dot(felt_, felt_) > 0;
    if (!touching_) gained_ = taken_ = 0;
  }

  /// Where to try next, after a trial that is no balance.
  Vec3 next(const Trial& now) {
    // Outside the body nothing is learnt of it: is the tool free, or was that too far?
    if (!now.pushes()) return been_out_ ? base_.tool + 0.25 * (now.tool - base_.tool) : way_out_;
    if (!exact_ || length(now.left) < length(base_.left)) {
      base_ = now;
      shorter_ = 1;
    } else {
      shorter_ *= 0.5;
    }
    exact_ = true;
    return within(base_.tool + shorter_ * step(base_.left));
  }

  /// From the way between the base and this trial.
  void learn(const Trial& now) {
    const Vec3 way = now.tool - base_.tool, change = now.force - base_.force;
    const double size = dot(way, way);
    if (!(size > 0)) return;
    if (!touching_ && !exact_) return expect(now.force, -way);
    // Broyden's update. Where the tool was in the last tick its force may have become another without a motion, by a
    // turn: what would change much is not believed.
    const Vec3 missing{change.x + dot(slope_[0], way), change.y + dot(slope_[1], way), change.z + dot(slope_[2], way)};
    if (!exact_ && !(length(missing) <= 0.3 * slope() * std::sqrt(size))) return;
    slope_[0] = slope_[0] - (missing.x / size) * way;
    slope_[1] = slope_[1] - (missing.y / size) * way;
    slope_[2] = slope_[2] - (missing.z / size) * way;
  }

  /// Of a contact that begins: all of its force has come on the way since the last tick, as far as that was against it.
  void expect(const Vec3& force, const Vec3& way) {
    const Vec3 n = unit(force, {});
    const double came = dot(way, n), rise = length(force) / (came > 0 ? came : length(way));
    slope_[0] = rise * n.x * n;
    slope_[1] = rise * n.y * n;
    slope_[2] = rise * n.z * n;
  }

  /// N/m, no less than the steepest.
  [[nodiscard]] double slope() const {
    return std::sqrt(dot(slope_[0], slope_[0]) + dot(slope_[1], slope_[1]) + dot(slope_[2], slope_[2]));
  }

  /// m, by which a tool with so much force left (N) comes to its balance if the slope is what it was; not much farther
  /// than without contact.
  [[nodiscard]] Vec3 step(const Vec3& left) const {
    const Vec3 a = slope_[0] + Vec3{stiff_, 0, 0}, b = slope_[1] + Vec3{0, stiff_, 0},
               c = slope_[2] + Vec3{0, 0, stiff_};
    const Vec3 bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
    const Vec3 way = (1 / dot(a, bc)) * (left.x * bc + left.y * ca + left.z * ab);
    const bool usable = dot(way, left) > 0 && stiff_ * length(way) <= 1.5 * length(left);
    return usable ? way : (1 / stiff_) * left;
  }

  CouplingOptions options_;
  bool usable_;
  bool started_ = false, touching_ = false;
  int repeated_ = 0;          ///< in a row
  Tick given_;                ///< in the last tick
  Vec3 device_, tool_, lag_;  ///< m, in the last tick; lag_: from device to tool
  Vec3 force_, felt_;         ///< N, the contact's on the tool, the coupling's on the hand
  Vec3 torque_;               ///< N m, the contact's
  Pose pose_;                 ///< the device's, in the last tick
  Vec3 slope_[3];             ///< N/m, rows: how the contact's force falls as the tool moves
  double lost_ = 0;           ///< J
  double gained_ = 0;         ///< J, work of the contact on the tool since it began to touch
  double taken_ = 0;          ///< J, the most that this was below 0

  // Of one tick.
  double damper_ = 0, stiff_ = 0;  ///< N/m, of the damper's step, and of spring and damper
  Vec3 turn_;                      ///< rad, since the last tick
  Vec3 goal_, way_out_;            ///< m, where the tool would be without contact; as far towards it as it may leap
  double leap_ = 0, near_ = 0;     ///< m, that the tool may go; that it may lie beside its balance
  double noise_ = 0;               ///< N, of the coupling's force by the rounding of positions
  Trial base_;                     ///< nearest to a balance so far
  bool exact_ = false;             ///< it is of this tick, not as the last one left it
  bool been_out_ = false;          ///< the way out was tried
  double shorter_ = 1;             ///< share of a step after steps that were none
  bool balanced_ = false;
  int trials_ = 0;
};

}  // namespace palpate::runtime
