// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/straight_press.hpp"

#include "palpate/runtime.hpp"

namespace palpate::cli {

using runtime::Vec3;

double straight_press(const runtime::View& view, std::uint32_t tool, std::uint32_t site, double depth) {
  const Vec3 up = runtime::to_vec(view.sites[site].normal), c = runtime::to_vec(view.sites[site].position);
  runtime::Pose pose = runtime::Pose::from_quaternion(1.000001 + up.z, -up.y, up.x, 0, c);
  pose.translation = c - runtime::find_touch(view, tool, pose).clearance * up;
  runtime::Contact contact(view, tool);
  constexpr int kSteps = 200;
  runtime::Tick last = contact.tick(pose);
  for (int k = 0; k < kSteps; ++k) {
    pose.translation = pose.translation - depth / kSteps * up;
    last = contact.tick(pose);
  }
  return runtime::length(last.force);
}

}  // namespace palpate::cli
