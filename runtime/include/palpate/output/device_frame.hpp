// SPDX-License-Identifier: MIT
// Place and scale of a device in the scene.
#pragma once

#include "palpate/math/pose.hpp"

#include <cmath>

namespace palpate::runtime {

/// Converts poses from a device to the scene, and forces back. A frame with a wrong member returns zero forces.
struct DeviceFrame {
  Pose pose;               ///< device to scene; the translation (m, scene) is the device's origin
  double scale = 1;        ///< metres of the scene in a metre of the hand, above 0
  double force_scale = 1;  ///< force of the hand over force of the scene, at least 0

  /// Returns null, or the member that is out of range.
  [[nodiscard]] const char* validate() const {
    if (!pose.valid()) return "pose of the device in the scene is no pose: not finite, or no rotation within 1e-3";
    if (!(scale > 0 && std::isfinite(scale))) return "motion scale of the device is outside (0, inf)";
    if (!(force_scale >= 0 && std::isfinite(force_scale))) return "force scale of the device is outside [0, inf)";
    return nullptr;
  }

  /// Returns the pose in the scene of a pose of the device.
  [[nodiscard]] Pose to_scene(Pose device) const {
    device.translation = scale * device.translation;
    return pose * device;
  }

  /// Returns a force of the scene (N) in the device's frame. With force_scale = scale the hand does the scene's work.
  [[nodiscard]] Vec3 to_device(const Vec3& force) const { return to_device(force, force_scale); }

  /// Returns a torque of the scene (N m) in the device's frame. A lever is `scale` times shorter for the hand, so the
  /// factor is force_scale / scale. Any other factor would produce energy from translations followed by rotations.
  [[nodiscard]] Vec3 torque_to_device(const Vec3& torque) const { return to_device(torque, force_scale / scale); }

private:
  [[nodiscard]] Vec3 to_device(const Vec3& v, double factor) const {
    return validate() == nullptr ? factor * inverse(pose).rotate(v) : Vec3{};
  }
};

}  // namespace palpate::runtime
