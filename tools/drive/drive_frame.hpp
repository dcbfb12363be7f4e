// SPDX-License-Identifier: GPL-3.0-or-later
// Default place of a device in a scene: over the body's top, its own upward axis along the scene's.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "palpate/palpate.hpp"

namespace palpate::cli {

struct FrameOptions {
  runtime::Vec3 up{0, 0, 1};         ///< of the scene, unit
  runtime::Vec3 device_up{0, 0, 1};  ///< of the device, unit
  double scale = 1;                  ///< m of the scene for one of the hand, above 0
  double force_scale = 1;            ///< N on the hand for one in the scene, at least 0
  double gap = 0.01;                 ///< m of the hand from the nearest tip down to the body, at least 0
  std::vector<runtime::Pose> tips{runtime::Pose{}};  ///< device's frame: where it begins to hold the tool; one a finger
  std::optional<runtime::Vec3> at;  ///< m, scene: position of the device's origin; by default over the body's top
};

/// The smallest turn that takes the device's upward axis to the scene's, and an origin so high over the site whose
/// normal points upward and that is highest of those with a response of their own (of all, where there is none) that
/// every tip keeps the gap. Throws Error(bad_input) where the tool finds no free place there.
runtime::DeviceFrame place_device(const runtime::View& view, std::uint32_t tool, const FrameOptions& options);

/// m of the scene from the tool at the nearest of these tips (device's frame) to the body.
double clearance(const runtime::View& view, std::uint32_t tool, const runtime::DeviceFrame& frame,
                 const std::vector<runtime::Pose>& tips);

/// "x", "-z" and so on; nothing for anything else.
std::optional<runtime::Vec3> axis_named(const std::string& name);

}  // namespace palpate::cli
