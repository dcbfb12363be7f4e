// SPDX-License-Identifier: MIT
// Contact with a body that moves rigidly: carried by breathing, turned by the other hand.
#pragma once

#include "palpate/contact.hpp"

namespace palpate::runtime {

/// A tick of a body, seen from where `body` takes the body's frame.
inline Tick carried(const Pose& body, Tick tick) {
  tick.force = body.rotate(tick.force);
  tick.torque = body.rotate(tick.torque);
  tick.body_point = body.apply(tick.body_point);
  tick.tool_point = body.apply(tick.tool_point);
  return tick;
}

/// A Contact whose body has a pose of its own in the world. The response is that of the body at rest: what it does to
/// inertia or to supports that move with it is not felt. Whether the tool or the body moves makes no difference, so the
/// force is as continuous as the two motions are, and a body that presses itself on a tool at rest does the work.
class MovingContact {
public:
  MovingContact(const View& view, std::uint32_t tool, const ContactSettings& settings = {})
      : contact_(view, tool, settings) {}

  void reset() { contact_.reset(); }

  /// Both poses to the world; so are force, torque (about the origin of the tool's frame) and the two points of the
  /// tick. A pose of the body that is no pose is a fault, as one of the tool is.
  Tick tick(const Pose& body, const Pose& tool) {
    const Tick tick = contact_.tick(body.valid() && tool.valid() ? inverse(body) * tool : no_pose());
    return tick.state == State::stick || tick.state == State::slide ? carried(body, tick) : tick;
  }

  [[nodiscard]] const Contact& contact() const { return contact_; }

private:
  static Pose no_pose() { return {{}, {HUGE_VAL, 0, 0}}; }

  Contact contact_;
};

}  // namespace palpate::runtime
