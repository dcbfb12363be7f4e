// SPDX-License-Identifier: MIT
// Handles: tools without mass on the springs of the hands' devices.
#pragma once

#include "palpate/contact/tick.hpp"
#include "palpate/math/rotation.hpp"
#include "palpate/mechanism/constraint.hpp"

#include <array>
#include <cstddef>

namespace palpate::runtime {

/// The spring between the hand's device and a tool without mass.
struct HandleSpring {
  double stiffness = 500;  ///< N/m, (0, 1e9]: upper bound of the stiffness that the hand feels
  double rotation = 1;     ///< N m/rad, [1e-3, 1e9]; 1e-3 for a device without torque: below, a contact spins the tool
  Vec3 grip;               ///< m, of the tool's frame, where the hand holds it

  /// Returns null, or the member that is out of range.
  [[nodiscard]] const char* validate() const {
    if (!(stiffness > 0 && stiffness <= 1e9)) return "stiffness of a handle is outside (0, 1e9] N/m";
    if (!(rotation >= 1e-3 && rotation <= 1e9)) {
      return "rotational stiffness of a handle is outside [1e-3, 1e9] N m/rad";
    }
    if (!finite(grip)) return "grip of a handle is not finite";
    return nullptr;
  }
};

/// Force and torque of a handle's spring on the hand.
struct HandleForce {
  Vec3 force;    ///< N
  Vec3 torque;   ///< N m, about the grip
  Pose tool;     ///< tool to world
  Tick contact;  ///< of the tool alone, where the mechanism has contacts
};

/// A tool on its spring.
struct Handle {
  HandleSpring spring;
  Pose device, tool;   ///< to world
  Vec3 shift, turn;    ///< m and rad (rotation vector): way from device to tool, of the grip
  Vec3 force, torque;  ///< N and N m about the grip, of the rows on the tool

  /// m, world.
  [[nodiscard]] Vec3 grip() const { return tool.apply(spring.grip); }
  /// Puts the tool at its way from the device.
  void place() {
    tool = rotation_pose(turn) * device;
    tool.translation = device.apply(spring.grip) + shift - tool.rotate(spring.grip);
  }
};

/// One row of J: way of a gap (m) per motion of the (up to two) handles that it joins.
struct Lever {
  int handle[2] = {-1, -1};
  Vec3 force[2];   ///< m per m of the handle
  Vec3 torque[2];  ///< m per rad, about its grip
};

/// All handles of a mechanism, and where points and directions are that move with them.
template <int Count>
class HandleSet {
public:
  explicit HandleSet(const std::array<HandleSpring, static_cast<std::size_t>(Count)>& springs) {
    for (std::size_t h = 0; h < handle_.size(); ++h) handle_[h].spring = springs[h];
  }

  [[nodiscard]] Handle& operator[](std::size_t h) { return handle_[h]; }
  [[nodiscard]] const Handle& operator[](std::size_t h) const { return handle_[h]; }
  [[nodiscard]] auto begin() { return handle_.begin(); }
  [[nodiscard]] auto end() { return handle_.end(); }

  /// m, world.
  [[nodiscard]] Vec3 position(const Side& side) const {
    return side.handle >= 0 ? at(side.handle).tool.apply(side.point) : side.point;
  }
  /// Direction k of a constraint, unit, world.
  [[nodiscard]] Vec3 direction(const Constraint& c, int k) const {
    if (c.frame == DirectionFrame::line) return unit(position(c.b) - position(c.a), c.direction[k]);
    const bool turns = c.frame == DirectionFrame::tool && c.a.handle >= 0;
    return turns ? at(c.a.handle).tool.rotate(c.direction[k]) : c.direction[k];
  }

  /// The lever of a row along `along` (unit, world) at `place` (m, world) between handles `a` and `b`; -1 for none.
  [[nodiscard]] Lever lever(int a, int b, const Vec3& place, const Vec3& along) const {
    Lever l;
    const int sides[2] = {a, b};
    for (int s = 0; s < 2; ++s) {
      if (sides[s] < 0) continue;
      l.handle[s] = sides[s];
      l.force[s] = (s == 0 ? 1.0 : -1.0) * along;
      l.torque[s] = cross(place - at(sides[s]).grip(), l.force[s]);
    }
    return l;
  }
  /// m/N, J K^-1 J^T of two rows.
  [[nodiscard]] double compliance(const Lever& a, const Lever& b) const {
    double sum = 0;
    for (int s = 0; s < 2; ++s) {
      for (int t = 0; t < 2; ++t) {
        if (a.handle[s] < 0 || a.handle[s] != b.handle[t]) continue;
        const HandleSpring& spring = at(a.handle[s]).spring;
        sum += dot(a.force[s], b.force[t]) / spring.stiffness + dot(a.torque[s], b.torque[t]) / spring.rotation;
      }
    }
    return sum;
  }
  /// `gap` (m) less J u: as it would be with the tools at their devices.
  [[nodiscard]] double at_devices(const Lever& l, double gap) const {
    for (int s = 0; s < 2; ++s) {
      if (l.handle[s] < 0) continue;
      const Handle& h = at(l.handle[s]);
      gap -= dot(l.force[s], h.shift) + dot(l.torque[s], h.turn);
    }
    return gap;
  }

  /// Puts the tools where their springs are in balance with `count` rows of these forces (N).
  void balance(const Lever* levers, const double* forces, int count) {
    for (Handle& h : handle_) h.force = h.torque = {};
    for (int i = 0; i < count; ++i) {
      for (int s = 0; s < 2; ++s) {
        if (levers[i].handle[s] < 0) continue;
        Handle& h = handle_[static_cast<std::size_t>(levers[i].handle[s])];
        h.force = h.force + forces[i] * levers[i].force[s];
        h.torque = h.torque + forces[i] * levers[i].torque[s];
      }
    }
    for (Handle& h : handle_) {
      h.shift = (1 / h.spring.stiffness) * h.force;
      h.turn = (1 / h.spring.rotation) * h.torque;
      h.place();
    }
  }

private:
  [[nodiscard]] const Handle& at(int h) const { return handle_[static_cast<std::size_t>(h)]; }

  std::array<Handle, static_cast<std::size_t>(Count)> handle_;
};

}  // namespace palpate::runtime
