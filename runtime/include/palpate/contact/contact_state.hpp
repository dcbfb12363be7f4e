// SPDX-License-Identifier: MIT
// The state of a contact from one tick to the next.
#pragma once

#include "palpate/contact/energy_tank.hpp"
#include "palpate/contact/friction_springs.hpp"
#include "palpate/contact/tick.hpp"

namespace palpate::runtime {

/// The place of a contact.
struct ContactPlace {
  Location foot;        ///< f: point of the undeformed body nearest to the tool's core
  Location body_point;  ///< c: point of the undeformed body whose responses are used
  Vec3 target;          ///< m, what c is the closest point of: the foot less the springs' deflection
  double lag = 0;       ///< m, by which the response is behind c
  CorePoint tool_point; ///< p
  Vec3 normal;          ///< n, unit, outward
  Vec3 axis;            ///< unit, across n: the x axis of the tangential vectors
};

/// m, how far the response in use went over the body from one tick to the next.
[[nodiscard]] inline double response_way(const ContactPlace& from, const ContactPlace& to) {
  return length(to.body_point.point - from.body_point.point) + from.lag - to.lag;
}

/// Force on the tool.
struct AppliedForce {
  Vec3 force;                   ///< N
  Vec3 point;                   ///< m, of the tool's frame, where it acts
  double normal_slope = 0;      ///< N/m, of the force along the normal
  double tangential_slope = 0;  ///< N/m, of the force across it where nothing slips, mean over the directions
};

/// Everything that a contact remembers, in the body's frame as baked.
struct ContactState {
  bool touching = false;
  bool blended = false;  ///< whether this contact has a response in use; its first tick blends it
  Pose tool;             ///< at the last tick
  ContactPlace place;
  SpringState springs;   ///< friction
  Vec2 recovery;         ///< m, deflection of the recovery layer
  EnergyTank energy;
  double other = 0;          ///< J stored beside W, at a body's factor of 1
  double indentation = 0;    ///< z, m
  double counted_depth = 0;  ///< m, in [0, z]
  double factor = 1;         ///< stiffness factor of the body at c
  AppliedForce applied;

  void reset() {
    const ContactState none;
    *this = none;
  }
};

}  // namespace palpate::runtime
