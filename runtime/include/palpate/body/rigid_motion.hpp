// SPDX-License-Identifier: MIT
// A body that moves rigidly: carried by breathing, turned by the other hand.
#pragma once

#include "palpate/body/body.hpp"

namespace palpate::runtime {

/// A body with a pose of its own in the world. Whether the tool or the body moves makes no difference to the force; the
/// response is that of the body at rest, without inertia. See StillBody for the members.
struct RigidMotion {
  const View* view;
  Pose pose;  ///< of the body's frame in the world; its rotation is made orthonormal

  [[nodiscard]] bool valid() const { return pose.valid(); }
  [[nodiscard]] Pose frame(const BodyPoint& /*at*/) const { return orthonormal(pose); }
  [[nodiscard]] const View& surface() const { return *view; }
  [[nodiscard]] Pose surface_frame() const { return orthonormal(pose); }
  [[nodiscard]] double travel() const { return 0; }
  [[nodiscard]] double factor(const BodyPoint& /*at*/) const { return 1; }
  [[nodiscard]] double factor_step() const { return HUGE_VAL; }
};

}  // namespace palpate::runtime
