// SPDX-License-Identifier: MIT
// Virtual coupling: a spring and a damper between the device and the tool that touches the body.
#pragma once

#include "palpate/contact/tick_frame.hpp"
#include "palpate/math/rotation.hpp"
#include "palpate/output/balance_search.hpp"

#include <cmath>

namespace palpate::runtime {

/// Returns the size (m) of a contact. Contacts of other kinds have an overload in their own namespace.
template <class Contact>
double contact_size(const Contact& contact) {
  return contact.size(contact.view().meta->depth_scale);
}

/// No coupling: the tool is the device.
struct Rigid {
  template <class Contact, class... More>
  auto tick(Contact& contact, const Pose& device, double /*seconds*/, const More&... more) const {
    return contact.tick(device, more...);
  }
  void reset() {}
};

struct CouplingOptions {
  double stiffness = 500;  ///< N/m, (0, 1e12]: upper bound of the stiffness that the hand feels
  double damping = 0;      ///< N s/m, [0, 1e9]; the device needs as much damping more (device/stability/stability.hpp)
  int trials = 8;          ///< [2, 64]: most ticks of the contact in one tick of the coupling

  /// Returns null, or the option that is out of range.
  [[nodiscard]] const char* validate() const {
    if (!(stiffness > 0 && stiffness <= 1e12)) return "stiffness of the virtual coupling is outside (0, 1e12] N/m";
    if (!(damping >= 0 && damping <= 1e9)) return "damping of the virtual coupling is outside [0, 1e9] N s/m";
    if (!(trials >= 2 && trials <= 64)) return "trials of the virtual coupling are outside [2, 64]";
    return nullptr;
  }
};

/// Energies of a coupling (J).
struct CouplingEnergy {
  double lost = 0;    ///< dissipated by damper and implicit step, at least 0
  double gained = 0;  ///< work of the contact on the tool since it began to touch
  double taken = 0;   ///< largest work of the tool on the contact since then
};

/// Everything that a coupling remembers, in the frame of the device's poses.
struct CouplingState {
  bool started = false, touching = false;
  int repeats = 0;     ///< ticks without time, in a row
  Tick tick;           ///< the last tick; its force is that of the coupling
  Pose device;         ///< at the last tick
  Vec3 tool;           ///< m
  Vec3 force, torque;  ///< N and N m, of the contact on the tool
  CouplingEnergy energy;
  BodyPoint anchor;  ///< last c; the body's motion is that of this point
  Pose frame;        ///< frame of the body at the anchor
};

/// Holds a tool without mass between device and contact (Colgate, Stanley and Brown 1995; Adams and Hannaford 1999). In
/// every tick the tool is at the point x where the contact and the coupling are in balance:
///
///     F(x) = K s + B (s - s_last) / T,     s = x - device
///
///     F  force of the contact on the tool (N)        K  CouplingOptions::stiffness (N/m)
///     B  CouplingOptions::damping (N s/m)            T  time since the last tick (s)
///
/// The hand feels the right side, and the torque of the contact. The tool rotates with the device. The damper takes
/// Euler's implicit step, so the coupling is passive for any motion and any T: K s . ds is at least the change of
/// K s^2 / 2. Without damper the felt force is the Moreau-Yosida regularisation of the contact (Moreau 1965): a slope k
/// is felt as K k / (K + k). A tool without contact has exactly no force.
///
/// BalanceSearch finds x by trials from one state of the contact; a copy of the contact is on the stack. Two
/// inequalities hold in every tick:
///
///     lost + work into the coupling from both sides - change of K s^2 / 2 >= 0
///     gained + work of the contact on the tool in this tick <= kMostGain taken
///
/// The first bounds the work of the residual. The second bounds the contact, because a tool without mass may slide half
/// a contact's size in one tick: on a coarse body without friction 67 mJ came out in 2 s. A tick without a balance that
/// keeps both leaves the tool at the best trial, else at its last position. The state is `stick` while the force is not
/// 0, even where the tool has just left the body; depth, torque and limit are 0 then.
class VirtualCoupling {
public:
  /// Ticks without time that repeat the last tick; the next such tick is a fault. A stopped clock holds no force.
  static constexpr int kRepeats = 8;
  /// Most work of the contact on the tool, as a share of `taken`. Promise 6 of the contact is 2 % of what went through.
  static constexpr double kMostGain = 0.01;

  /// Options that are out of range make every tick a fault.
  explicit VirtualCoupling(const CouplingOptions& options)
      : options_(options), usable_(options.validate() == nullptr) {}

  /// Returns the force of `contact` on the hand; the other values are those of the tool. A fault resets everything.
  /// `contact`: a BasicContact, or a copyable type with reset(), tick() and contact_size().
  /// `device`: pose in the frame of the contact's poses.
  /// `seconds`: since the last tick, above 0. Time 0 (a repeated sample) repeats the last tick.
  /// `more`: further arguments of contact.tick(), such as a Body or a Search. The last tick moves along with a Body.
  template <class Contact, class... More>
  Tick tick(Contact& contact, const Pose& device, double seconds, const More&... more) {
    if (!usable_) return fail(contact, Fault::bad_option);
    if (!device.valid()) return fail(contact, Fault::bad_pose);
    if (seconds == 0 && state_.repeats < kRepeats) return ++state_.repeats, state_.tick;
    if (!(seconds > 0 && std::isfinite(seconds))) return fail(contact, Fault::bad_time);
    state_.repeats = 0;
    const double size = contact_size(contact);
    if (state_.started) (follow(more, 0), ...);
    // A device that moved farther was put elsewhere.
    if (state_.touching && length(device.translation - state_.device.translation) > size) {
      contact.reset();
      state_.started = state_.touching = false;
      state_.tick = {};
    }
    begin(device, seconds, size);

    const Contact before = contact;
    Pose pose = device;
    Tick tick, touched = state_.tick;
    const auto try_at = [&](const Vec3& tool) {
      if (trials_++ > 0) contact = before;
      pose.translation = tool;
      tick = contact.tick(pose, more...);
      if (tick.touches()) touched = tick;
      return search_.trial(tool, tick.force, tick.torque);
    };
    BalanceTrial now = try_at(search_.first());
    while (tick.state != State::fault && !accept(now) && trials_ < options_.trials) now = try_at(search_.next(now));
    if (tick.state == State::fault) return fail(contact, tick.fault);
    if (!balanced_) {
      const BalanceTrial* best = search_.best();
      const Vec3 kept = best != nullptr && is_passive(*best) ? best->tool : state_.tool;
      if (length(kept - now.tool) > 0) now = try_at(kept);
      keep(now);
    }
    if (state_.touching && !tick.touches()) {
      tick = touched;
      tick.state = State::stick;
      tick.torque = {};
      tick.depth = tick.counted_depth = tick.friction_limit = tick.filled_share = 0;
      tick.extrapolated = false;
    }
    tick.force = spring_.force(now.tool);
    state_.tick = tick;
    if (tick.touches()) state_.anchor = tick.at;
    (set_frame(more, 0), ...);
    return tick;
  }

  /// Forgets everything: the tool is at the device, and free.
  void reset() { *this = VirtualCoupling(options_); }

  [[nodiscard]] const char* validate() const { return options_.validate(); }
  [[nodiscard]] const CouplingOptions& options() const { return options_; }
  [[nodiscard]] const CouplingState& state() const { return state_; }
  [[nodiscard]] const Vec3& tool() const { return state_.tool; }    ///< m
  [[nodiscard]] double lost() const { return state_.energy.lost; }  ///< J, dissipated, at least 0
  [[nodiscard]] int trials() const { return trials_; }              ///< ticks of the contact in the last tick
  [[nodiscard]] bool balanced() const { return balanced_; }         ///< the last tick found its balance
  /// J, in the spring.
  [[nodiscard]] double stored() const {
    const Vec3 lag = state_.tool - state_.device.translation;
    return 0.5 * options_.stiffness * dot(lag, lag);
  }

private:
  template <class Contact>
  Tick fail(Contact& contact, Fault fault) {
    contact.reset();
    reset();
    state_.repeats = kRepeats;  // a stopped clock stays a fault
    Tick tick;
    tick.state = State::fault;
    tick.fault = fault;
    return tick;
  }

  /// Moves the state along with a body's motion since the last tick; at rest it keeps every bit. Other arguments of the
  /// tick have no frame.
  template <class Body>
  auto follow(const Body& body, int) -> decltype(body.frame(BodyPoint{}), void()) {
    const Pose frame = frame_at(body, state_.anchor);
    if (frame == state_.frame) return;
    const Pose motion = frame * inverse(state_.frame);
    state_.device = motion * state_.device;
    state_.tool = motion.apply(state_.tool);
    state_.force = motion.rotate(state_.force);
    state_.torque = motion.rotate(state_.torque);
    state_.tick = transformed(motion, state_.tick);
  }
  template <class Other>
  void follow(const Other& /*no body*/, long) {}
  template <class Body>
  auto set_frame(const Body& body, int) -> decltype(body.frame(BodyPoint{}), void()) {
    state_.frame = frame_at(body, state_.anchor);
  }
  template <class Other>
  void set_frame(const Other& /*no body*/, long) {}

  void begin(const Pose& device, double seconds, double size) {
    if (!state_.started) {
      state_.started = true;
      state_.tool = device.translation;
      state_.device = device;
      state_.force = state_.torque = {};
      state_.energy.gained = state_.energy.taken = 0;
    }
    rotation_ = state_.touching ? small_rotation(device * inverse(state_.device)) : Vec3{};
    last_lag_ = state_.tool - state_.device.translation;
    state_.device = device;
    spring_.damper = options_.damping / seconds;
    spring_.stiffness = options_.stiffness + spring_.damper;
    spring_.goal = device.translation + (spring_.damper / spring_.stiffness) * last_lag_;
    trials_ = 0;
    balanced_ = false;
    search_.begin(spring_, {state_.tool, state_.force, state_.torque, {}}, size, state_.touching);
  }

  /// Returns true, and keeps the trial, where it is a balance that the inequalities allow.
  bool accept(BalanceTrial& now) {
    if (search_.observe(now)) {
      now = {spring_.goal, {}, {}, {}};
    } else if (!search_.balanced(now) || !is_passive(now)) {
      return false;
    }
    balanced_ = true;
    keep(now);
    return true;
  }

  /// J dissipated in this tick: work into the coupling from both sides less the change of the stored energy.
  [[nodiscard]] double loss(const BalanceTrial& now) const {
    const Vec3 stretch = now.tool - state_.device.translation - last_lag_, way = now.tool - state_.tool;
    return (0.5 * options_.stiffness + spring_.damper) * dot(stretch, stretch) + dot(now.residual, way);
  }

  /// J of the contact on the tool in this tick (trapezoid): force of the coupling, and torque.
  [[nodiscard]] double gain(const BalanceTrial& now) const {
    const Vec3 force = state_.tick.force + spring_.force(now.tool), torque = state_.torque + now.torque;
    return 0.5 * (dot(force, now.tool - state_.tool) + dot(torque, rotation_));
  }

  /// True where the two inequalities of energy hold after this trial.
  [[nodiscard]] bool is_passive(const BalanceTrial& now) const {
    const CouplingEnergy& energy = state_.energy;
    const double more = gain(now);
    return energy.lost + loss(now) >= -search_.rounding() * length(now.tool - state_.tool) &&
           (!state_.touching || !(more > 0) || energy.gained + more <= kMostGain * energy.taken);
  }

  void keep(const BalanceTrial& now) {
    CouplingEnergy& energy = state_.energy;
    energy.lost = std::fmax(0, energy.lost + loss(now));
    energy.gained += gain(now);
    energy.taken = std::fmax(energy.taken, -energy.gained);
    state_.tool = now.tool;
    state_.force = now.force;
    state_.torque = now.torque;
    const Vec3 force = spring_.force(now.tool);
    state_.touching = dot(force, force) > 0;
    if (!state_.touching) energy.gained = energy.taken = 0;
  }

  CouplingOptions options_;
  bool usable_;
  CouplingState state_;
  BalanceSearch search_;
  // The rest is of the last tick.
  CouplingSpring spring_;
  Vec3 last_lag_;  ///< m, from the device to the tool at the last tick
  Vec3 rotation_;  ///< rad, of the device since the last tick
  int trials_ = 0;
  bool balanced_ = false;
};

}  // namespace palpate::runtime
