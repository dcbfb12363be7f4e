// SPDX-License-Identifier: MIT
// What a contact answers in one tick.
#pragma once

#include "palpate/surface.hpp"

#include <cstdint>

namespace palpate::runtime {

enum class State : std::uint8_t {
  free,      ///< no contact, no force
  stick,     ///< c and p rest where they met
  slide,     ///< c moves over the body at the friction limit (always, in a frictionless file)
  released,  ///< the contact ended in this tick; no force
  /// No force, and the contact is forgotten: the pose of the tool, of the body that moves or of the search was not
  /// finite, no rotation, or beyond 1e6 m; the search named a place that the file does not have; the file has no such
  /// tool, or holds what the contact leaves out; a coupling's time or options were wrong.
  fault
};

/// What a tick gives back; vectors in the body's frame.
struct Tick {
  State state = State::free;
  Vec3 force;                   ///< N on the tool
  Vec3 torque;                  ///< N m on the tool, about the origin of its frame
  double depth = 0;             ///< m, along -n(c); 0 without contact
  double friction_limit = 0;    ///< N; 0 without depth, else infinite in a frictionless file
  double covered = 0;           ///< share of the blend's weights on responses taken from neighbours, [0, 1]
  bool beyond = false;          ///< deeper than the pair was sampled: the force is an extrapolation
  Vec3 body_point, tool_point;  ///< c and p (m); only in contact
  BodyPoint at;                 ///< c again
  ToolPoint on_tool;            ///< p again

  [[nodiscard]] bool touches() const { return state == State::stick || state == State::slide; }
};

}  // namespace palpate::runtime
