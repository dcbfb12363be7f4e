// SPDX-License-Identifier: MIT
// The tick of a contact in another frame.
#pragma once

#include "palpate/body/body.hpp"
#include "palpate/contact/tick.hpp"
#include "palpate/math/pose.hpp"

namespace palpate::runtime {

/// Returns the tick with all its points and vectors moved by a rigid motion. `frame` from the body to the world turns a
/// tick of the body's frame into a tick of the world's.
inline Tick transformed(const Pose& frame, Tick tick) {
  tick.force = frame.rotate(tick.force);
  tick.torque = frame.rotate(tick.torque);
  tick.normal = frame.rotate(tick.normal);
  tick.body_point = frame.apply(tick.body_point);
  tick.tool_point = frame.apply(tick.tool_point);
  return tick;
}

/// Returns the frame of a body near a point of its surface as a pose.
template <class Body>
Pose frame_at(const Body& body, const BodyPoint& at) {
  return body.frame(at) * Pose{};
}

}  // namespace palpate::runtime
