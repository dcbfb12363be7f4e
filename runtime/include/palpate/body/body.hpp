// SPDX-License-Identifier: MIT
// Bodies as a contact sees them: where they are now, and how stiff. A still body is the simplest.
#pragma once

#include "palpate/geometry/surface.hpp"
#include "palpate/math/pose.hpp"

#include <cmath>

namespace palpate::runtime {

/// The frame of a body that stays where it was baked.
struct StillFrame {
  [[nodiscard]] Vec3 rotate(const Vec3& a) const { return a; }
  [[nodiscard]] Vec3 unrotate(const Vec3& a) const { return a; }
  [[nodiscard]] Vec3 unapply(const Vec3& a) const { return a; }
};
inline const Pose& operator*(StillFrame /*frame*/, const Pose& pose) { return pose; }

/// A body that stays as it was baked. Every body has these members; a contact takes them as data of the tick.
struct StillBody {
  const View* view;

  /// Whether the numbers are such that a tick can use them.
  [[nodiscard]] bool valid() const { return true; }
  /// The rigid motion of the body near a point of its surface, from where it was baked to where it is (m).
  [[nodiscard]] StillFrame frame(const BodyPoint& /*at*/) const { return {}; }
  /// Surface that a free tool searches: a view of the present surface, and the pose of that view's frame in the world.
  [[nodiscard]] const View& surface() const { return *view; }
  [[nodiscard]] StillFrame surface_frame() const { return {}; }
  /// Upper bound (m) of the displacement of any surface point since the start. The difference of two values bounds the
  /// displacement between them.
  [[nodiscard]] double travel() const { return 0; }
  /// Factor (>= 0) on the stiffness at a point, and most that it may change by in a tick.
  [[nodiscard]] double factor(const BodyPoint& /*at*/) const { return 1; }
  [[nodiscard]] double factor_step() const { return HUGE_VAL; }
};

/// A pose of the world as it lies against a body.
inline const Pose& in_body(const Pose& tool, StillFrame /*frame*/) { return tool; }
inline Pose in_body(const Pose& tool, const Pose& frame) { return orthonormal(inverse(frame) * tool); }

}  // namespace palpate::runtime
