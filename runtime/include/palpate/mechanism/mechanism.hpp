// SPDX-License-Identifier: MIT
// Tools held by springs, joined to each other, to the ground and to bodies by constraints.
#pragma once

#include "palpate/body/rigid_motion.hpp"
#include "palpate/mechanism/row_system.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace palpate::runtime {

struct MechanismOptions {
  int sweeps = 8;  ///< [1, 64] of each solve
  int every = 1;   ///< [1, 1000] ticks from one assembly of W and J to the next; gaps are those of every tick

  /// Returns null, or the option that is out of range.
  [[nodiscard]] const char* validate() const {
    if (!(sweeps >= 1 && sweeps <= 64)) return "sweeps of a mechanism are outside [1, 64]";
    if (!(every >= 1 && every <= 1000)) return "ticks between assemblies of a mechanism are outside [1, 1000]";
    return nullptr;
  }
};

/// Constants of a mechanism.
struct MechanismConstants {
  /// Most ticks of each contact in one tick.
  static constexpr int kLooks = 8;
  /// Largest difference of a contact's force and its rows' over the largest force. A hand notices 7 %.
  static constexpr double kForceTolerance = 1e-3;
  /// Largest difference over the stiffness of the handle and a contact's size, for small forces.
  static constexpr double kPositionTolerance = 1e-5;
};

/// How the last tick of a mechanism ended.
struct MechanismOutcome {
  RowsOutcome rows;      ///< of the last solve
  int looks = 0;         ///< ticks of each contact
  bool balanced = true;  ///< the contacts found their balance
  /// Why the rows could not be solved, or null. The tools are at their devices then.
  const char* cause = nullptr;
};

/// Rigid tools without mass, each on the spring of its handle, with constraints and with contacts against one baked
/// body. In every tick tools, springs, constraints and contacts are in balance:
///
///     J^T f = K u                    K  springs (N/m, N m/rad)       u  way from the device to the tool (m, rad)
///     gap = g(u) + C f               C  compliance of the bodies      f  forces of the rows (N)
///
/// with the law of each row (rows.hpp). The rows of a contact (n and two across it) have the force of its own tick; D
/// is the inverse of its slope. Newton's method gives one linear problem a look,
///
///     gap = r + W (f - f_now),       W = J K^-1 J^T + C + D,         r  gap now; for a contact D (f_now - F(u))
///
/// so that the gaps of a settled mechanism do not depend on W, which may be some ticks old. A mechanism without
/// contacts takes one look, which is exact for small motions; the next tick's r holds the gap that a large rotation
/// leaves. The tools have no mass and the springs are linear: a mechanism without friction stores the work of the
/// hands, and friction rows dissipate.
///
/// Not for several threads at once. `MostRows`: rows of all constraints, three more for each contact. No tick
/// allocates.
template <int Handles, int MostRows, std::uint32_t kFeatures = layout::feature_all>
class Mechanism {
  static constexpr std::size_t kHandles = static_cast<std::size_t>(Handles);

public:
  using Contacts = std::array<BasicContact<kFeatures>, kHandles>;

  explicit Mechanism(const std::array<HandleSpring, kHandles>& springs, const MechanismOptions& options = {})
      : options_(options), fault_(options.validate()), handles_(springs) {
    for (const HandleSpring& spring : springs) {
      if (fault_ == nullptr) fault_ = spring.validate();
    }
  }

  /// Null, or why every tick is without force: an option out of range.
  [[nodiscard]] const char* validate() const { return fault_; }

  /// Adds a constraint, with the forces that it carries, and returns its index; -1 where it has no room or a wrong
  /// member (Constraint::validate). It acts from the next tick on.
  int add(const Constraint& constraint) { return add(&constraint, 1) ? count() - 1 : -1; }
  /// Adds all constraints of a joint. Returns false, and adds none, where one has a wrong member or all have no room.
  template <std::size_t N>
  bool add(const std::array<Constraint, N>& joint) {
    return add(joint.data(), N);
  }
  /// Removes all constraints. The tools stay.
  void clear() {
    constraints_.clear();
    changed_ = true;
  }
  [[nodiscard]] int count() const { return static_cast<int>(constraints_.size()); }
  [[nodiscard]] const Constraint& constraint(int i) const { return constraints_[static_cast<std::size_t>(i)]; }

  /// One tick without contacts. `devices`: poses of the hands' tools, in the world.
  std::array<HandleForce, kHandles> tick(const std::array<Pose, kHandles>& devices) {
    const bool usable = begin(devices);
    for (ContactRows& c : contacts_) {
      changed_ = changed_ || c.touching;
      c = {};
    }
    solve(usable);
    outcome_.looks = 1;
    outcome_.balanced = true;
    return forces();
  }

  /// One tick in which tool h has contacts[h] against `body`.
  std::array<HandleForce, kHandles> tick(const std::array<Pose, kHandles>& devices, Contacts& contacts,
                                         const CompliantBody& body) {
    const bool usable = begin(devices);
    const auto before = memories(contacts);
    std::array<Tick, kHandles> ticks;
    int& looks = outcome_.looks;
    for (looks = 1;; ++looks) {
      solve(usable);
      if (looks > 1) restore(contacts, before);
      outcome_.balanced = look(contacts, body, ticks);
      if (outcome_.balanced || looks == MechanismConstants::kLooks) break;
    }
    auto result = forces();
    for (std::size_t h = 0; h < kHandles; ++h) result[h].contact = ticks[h];
    return result;
  }

  /// How the last tick ended.
  [[nodiscard]] const MechanismOutcome& outcome() const { return outcome_; }

private:
  bool add(const Constraint* more, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const bool known = more[i].a.handle < Handles && more[i].b.handle < Handles;
      if (!known || more[i].validate() != nullptr) return false;
    }
    const bool fits = constraints_.add(more, count);
    changed_ = changed_ || fits;
    return fits;
  }

  /// Puts the tools at their way from the devices. False where no force can be made.
  bool begin(const std::array<Pose, kHandles>& devices) {
    bool valid = fault_ == nullptr;
    for (const Pose& pose : devices) valid = valid && pose.valid();
    outcome_.cause = fault_;
    if (!valid && fault_ == nullptr)
      outcome_.cause = "a pose is not finite, not a rotation within 1e-3, or beyond 1e6 m";
    for (std::size_t h = 0; valid && h < kHandles; ++h) {
      handles_[h].device = devices[h];
      handles_[h].place();
    }
    if (++since_ >= options_.every) changed_ = true;
    return valid;
  }

  /// Newton's step: forces of all rows, then the tools.
  void solve(bool usable) {
    if (!usable) return release(usable);
    if (changed_) {
      outcome_.cause = system_.assemble(handles_, constraints_, contacts_);
      since_ = 0;
      changed_ = false;
    }
    if (outcome_.cause != nullptr) return release(usable);
    outcome_.rows = system_.solve(handles_, constraints_, contacts_, options_.sweeps);
    if (outcome_.rows.finite) return;
    outcome_.cause = "forces of the rows are not finite";
    release(usable);
  }

  /// No forces: the tools are at their devices.
  void release(bool usable) {
    outcome_.rows = {HUGE_VAL, false};
    for (Handle& h : handles_) {
      h.force = h.torque = h.shift = h.turn = {};
      if (usable) h.place();
    }
    for (ContactRows& c : contacts_) c = {};
    constraints_.drop_forces();
    changed_ = true;
  }

  /// Ticks the contacts where the tools are. True where their forces are those of their rows.
  bool look(Contacts& contacts, const CompliantBody& body, std::array<Tick, kHandles>& ticks) {
    double most = 0, error[kHandles];
    for (std::size_t h = 0; h < kHandles; ++h) {
      ContactRows& c = contacts_[h];
      const double stiffness = handles_[h].spring.stiffness;
      Pose pose = handles_[h].tool;
      if (c.touching) pose.translation = pose.translation - system_.surface(h);
      ticks[h] = contacts[h].tick(pose, RigidMotion{body.view, body.pose});
      const bool touches = ticks[h].touches();
      const Vec3 force = touches ? body.pose.rotate(contacts[h].state().applied.force) : Vec3{};
      const Vec3 rows = c.row_force();
      most = larger(most, larger(length(force), length(rows)));
      const double size = contacts[h].size(body.view->meta->depth_scale);
      error[h] = length(force - rows) - MechanismConstants::kPositionTolerance * size * stiffness;
      changed_ = changed_ || touches || c.touching;
      if (touches) {
        c.update(contacts[h], pose, body, stiffness, outcome_.looks > 1);
      } else {
        c = {};
      }
    }
    bool good = true;
    for (const double e : error) good = good && e <= MechanismConstants::kForceTolerance * most;
    return good;
  }

  std::array<HandleForce, kHandles> forces() {
    if (outcome_.cause == nullptr) constraints_.slip(system_.rows());
    std::array<HandleForce, kHandles> result;
    for (std::size_t h = 0; h < kHandles; ++h) {
      result[h] = {handles_[h].force, handles_[h].torque, handles_[h].tool, {}};
    }
    return result;
  }

  MechanismOptions options_;
  const char* fault_ = nullptr;
  HandleSet<Handles> handles_;
  std::array<ContactRows, kHandles> contacts_;  ///< at their last tick
  ConstraintSet<MostRows> constraints_;
  RowSystem<Handles, MostRows> system_;  ///< of the last assembly
  bool changed_ = true;                  ///< the next solve needs an assembly
  int since_ = 0;                        ///< ticks since the last one
  MechanismOutcome outcome_;
};

}  // namespace palpate::runtime
