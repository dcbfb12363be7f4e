// SPDX-License-Identifier: MIT
// The answer of a contact in one tick.
#pragma once

#include "palpate/geometry/surface.hpp"
#include "palpate/geometry/tool_shape.hpp"

#include <cstdint>

namespace palpate::runtime {

enum class State : std::uint8_t {
  free,      ///< no contact, no force
  stick,     ///< part of the contact at least is below its friction limit
  slide,     ///< all of it is at the friction limit (always, in a frictionless file)
  released,  ///< the contact ended in this tick; no force
  fault      ///< no force, and the contact is forgotten: see Tick::fault
};

/// Why a tick is a fault.
enum class Fault : std::uint8_t {
  none,
  bad_pose,          ///< a pose of tool or body is not finite, no rotation (orthonormal to 1e-3), or beyond 1e6 m
  no_such_tool,      ///< the file has no tool of that index
  feature_left_out,  ///< the file has a feature that this contact's kFeatures leaves out
  /// The search names a place that the file does not have, or has no valid pose. A search that was made with another
  /// tool of the file is not detected.
  bad_search,
  bad_time,   ///< a time step is not positive
  bad_option  ///< options of a virtual coupling are out of range
};

/// The cause in words.
inline constexpr const char* describe(Fault fault) {
  switch (fault) {
    case Fault::none:
      return "no fault";
    case Fault::bad_pose:
      return "a pose is not finite, not a rotation within 1e-3, or beyond 1e6 m";
    case Fault::no_such_tool:
      return "the file has no tool of that index";
    case Fault::feature_left_out:
      return "the file has a feature that this contact leaves out";
    case Fault::bad_search:
      return "the search names a place that the file does not have, or has no valid pose";
    case Fault::bad_time:
      return "a time step is not positive";
    default:
      return "an option is out of range";
  }
}

/// Vectors are in the frame of the poses that were passed.
struct Tick {
  State state = State::free;
  Fault fault = Fault::none;
  Vec3 force;                   ///< N on the tool
  Vec3 torque;                  ///< N m on the tool, about the origin of its frame
  double depth = 0;             ///< m, indentation: overlap of the tool's skin with the undeformed body
  double counted_depth = 0;     ///< m, at most `depth`: the depth whose work E covers. The force is that of this depth
  double friction_limit = 0;    ///< N; 0 without contact, infinite in a frictionless file
  double filled_share = 0;      ///< [0, 1] of the blend that was filled from neighbouring sites
  bool extrapolated = false;    ///< deeper than the pair was sampled
  Vec3 normal;                  ///< unit, outward: direction of the normal force
  Vec3 body_point, tool_point;  ///< m: c, and the skin point at p
  BodyPoint at;                 ///< c
  CorePoint on_tool;            ///< p

  [[nodiscard]] bool touches() const { return state == State::stick || state == State::slide; }
};

}  // namespace palpate::runtime
