// SPDX-License-Identifier: MIT
// Rows of a baked contact in a mechanism: its force and slope at its last tick.
#pragma once

#include "palpate/mechanism/constraint.hpp"
#include "palpate/shared/contact_slope.hpp"

namespace palpate::runtime {

/// Three bilateral rows (n and two across it) with the force of the contact's own tick, and the inverse of its slope as
/// compliance.
struct ContactRows {
  /// Least slope of a contact over the stiffness of its handle: a contact that begins has none.
  static constexpr double kLeastSlope = 1e-6;

  bool touching = false;
  Vec3 point;                 ///< m, of the tool's frame, where the force acts
  Vec3 place;                 ///< m, world: this point less the surface's displacement
  Vec3 force;                 ///< N, world, on the tool
  Vec3 direction[3];          ///< n and two across it, world
  double row[3] = {};         ///< N, forces of the rows
  double compliance[3] = {};  ///< m/N, D
  double grip = 1;            ///< share of the tangential stiffness, learnt
  ContactSlope slope;
  const CompliantBody* body = nullptr;
  CompliancePoint at;  ///< of the body, under the contact

  /// N, world; 0 without contact.
  [[nodiscard]] Vec3 row_force() const {
    Vec3 sum;
    for (int k = 0; touching && k < 3; ++k) sum = sum + row[k] * direction[k];
    return sum;
  }

  /// Takes the state of `contact` after its tick with the tool at `pose`, which touches `on`. `stiffness` (N/m): of the
  /// handle. `again`: the tick is not the first of this cycle, and its change of the force teaches the grip.
  template <std::uint32_t kFeatures>
  void update(const BasicContact<kFeatures>& contact, const Pose& pose, const CompliantBody& on, double stiffness,
              bool again) {
    const ContactState& state = contact.state();
    const Vec3 now = on.pose.rotate(state.applied.force), rows = row_force();
    if (touching && again) {
      slope.learn_grip(on.pose.unrotate(pose.apply(point) - place), on.pose.unrotate(now - force), grip);
    }
    touching = true;
    body = &on;
    point = state.applied.point;
    place = pose.apply(point);
    force = now;
    slope = ContactSlope(contact, grip);
    on.compliance.locate(state.place.body_point.at, at);
    direction[0] = on.pose.rotate(state.place.normal);
    direction[1] = any_orthogonal(direction[0]);
    direction[2] = cross(direction[0], direction[1]);
    for (int k = 0; k < 3; ++k) row[k] = dot(direction[k], rows);
    const double least = kLeastSlope * stiffness;
    const double across = larger(least, slope.across * slope.across);
    compliance[0] = 1 / larger(least, slope.normal * slope.normal);
    compliance[1] = compliance[2] = 1 / across;
  }
};

}  // namespace palpate::runtime
