// SPDX-License-Identifier: MIT
// Several contacts of one tool where one is asked for: behind a virtual coupling, on a device.
#pragma once

#include "palpate/several.hpp"

#include <cmath>

namespace palpate::runtime {

/// SeveralContacts that tick as a Contact does. The tick is the first contact's, with the forces, torques and friction
/// limits of all added, the most of depth and of covered that any has, and beyond where any is. kFeatures as those of
/// BasicContact.
template <int Most = 2, std::uint32_t kFeatures = layout::feature_all>
class ContactsAsOne {
public:
  ContactsAsOne(const View& view, std::uint32_t tool) : contacts_(view, tool) {}
  ContactsAsOne(const View&&, std::uint32_t) = delete;

  void reset() {
    contacts_.reset();
    last_ = {};
  }

  Tick tick(const Pose& pose) { return sum(contacts_.tick(pose)); }
  Tick tick(const Pose& pose, const SeveralSearch<Most>& latest) { return sum(contacts_.tick(pose, latest)); }

  /// Of the last tick: each contact's own, and how far their sum can be trusted.
  [[nodiscard]] const SeveralTick<Most>& last() const { return last_; }
  /// m, BasicContact::size().
  [[nodiscard]] double size() const { return contacts_.contact(0).size(); }

private:
  Tick sum(const SeveralTick<Most>& ticks) {
    last_ = ticks;
    Tick tick = ticks.each[0];
    tick.force = ticks.force;
    tick.torque = ticks.torque;
    tick.friction_limit = 0;
    for (const Tick& each : ticks.each) {
      tick.friction_limit += each.friction_limit;
      tick.depth = std::fmax(tick.depth, each.depth);
      tick.covered = std::fmax(tick.covered, each.covered);
      tick.beyond = tick.beyond || each.beyond;
    }
    return tick;
  }

  SeveralContacts<Most, kFeatures> contacts_;
  SeveralTick<Most> last_;
};

/// As many places as hold a point: a concave body's walls, or lobes.
inline constexpr int kFeltPlaces = 3;
using FeltPlaces = ContactsAsOne<kFeltPlaces>;

}  // namespace palpate::runtime
