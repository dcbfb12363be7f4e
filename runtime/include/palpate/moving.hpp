// SPDX-License-Identifier: MIT
// Contact with a body that moves rigidly: carried by breathing, turned by the other hand.
#pragma once

#include "palpate/contact.hpp"

namespace palpate::runtime {

/// A tick of a body, seen from where `body` takes the body's frame. A fault stays as it is, for `body` may be no pose.
inline Tick carried(const Pose& body, Tick tick) {
  if (tick.state == State::fault) return tick;
  tick.force = body.rotate(tick.force);
  tick.torque = body.rotate(tick.torque);
  tick.body_point = body.apply(tick.body_point);
  tick.tool_point = body.apply(tick.tool_point);
  return tick;
}

/// A tool as it lies against a body that moves, both poses to the world. No pose where either is none, nor where they
/// are 1e6 m apart. Two rotations that are just good enough may together be less: it is orthonormal.
inline Pose seen_from(const Pose& body, const Pose& tool) {
  return body.valid() && tool.valid() ? orthonormal(inverse(body) * tool) : Pose{{}, {HUGE_VAL, 0, 0}};
}

/// For a thread that searches while another one makes forces (MovingContact::tick with a Search): where body and tool
/// were at one time.
template <std::uint32_t kFeatures = layout::feature_all>
inline Search search(const View& view, std::uint32_t index, const Pose& body, const Pose& tool) {
  return search<kFeatures>(view, index, seen_from(body, tool));
}

/// A Contact whose body has a pose of its own in the world. The response is that of the body at rest: what it does to
/// inertia or to supports that move with it is not felt. Whether the tool or the body moves makes no difference, so the
/// force is as continuous as the two motions are, and a body that presses itself on a tool at rest does the work.
/// A virtual coupling holds a tool against such a body in the body's frame, where what is passive at rest stays so,
/// with a Contact: carried(body, tie.tick(contact, seen_from(body, device), seconds)). kFeatures as those of
/// BasicContact.
template <std::uint32_t kFeatures = layout::feature_all>
class BasicMovingContact {
public:
  BasicMovingContact(const View& view, std::uint32_t tool) : contact_(view, tool) {}
  BasicMovingContact(const View&&, std::uint32_t) = delete;

  void reset() { contact_.reset(); }

  /// Both poses to the world; so are force, torque (about the origin of the tool's frame) and the two points of the
  /// tick. A pose of the body that is no pose is a fault, as one of the tool is, and so are two that are 1e6 m apart.
  /// For what takes a tick and a pose in the body's frame (a Grasp) `carried(inverse(body), tick)` and `seen_from(body,
  /// tool)` are these.
  Tick tick(const Pose& body, const Pose& tool) { return in_world(body, contact_.tick(seen_from(body, tool))); }

  /// The same with searches that are made elsewhere: search() of both poses.
  Tick tick(const Pose& body, const Pose& tool, const Search& latest) {
    return in_world(body, contact_.tick(seen_from(body, tool), latest));
  }

  [[nodiscard]] const BasicContact<kFeatures>& contact() const { return contact_; }

private:
  static Tick in_world(const Pose& body, const Tick& tick) { return tick.touches() ? carried(body, tick) : tick; }

  BasicContact<kFeatures> contact_;
};

using MovingContact = BasicMovingContact<>;

}  // namespace palpate::runtime
