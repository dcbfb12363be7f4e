// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/drive/drive_frame.hpp"

#include <cmath>

#include "formats/io/error.hpp"

namespace palpate::cli {
namespace {

using runtime::Pose;
using runtime::Vec3;

/// Takes unit vector a to b the short way.
Pose turn_to(const Vec3& a, const Vec3& b) {
  const double cosine = dot(a, b);
  if (cosine < -1 + 1e-9) {
    const Vec3 n = any_orthogonal(a);
    return Pose::from_quaternion(0, n.x, n.y, n.z, {});
  }
  const Vec3 n = cross(a, b);
  return Pose::from_quaternion(1 + cosine, n.x, n.y, n.z, {});
}

bool has_own_response(const runtime::View& view, std::uint32_t tool, std::uint32_t site) {
  const layout::ToolRecord& record = view.tools[tool];
  for (std::uint32_t k = 0; k < record.vertex_count; ++k) {
    const std::uint64_t index = layout::response_index(*view.meta, site, record.first_vertex + k);
    if (view.response_head(index).flags != layout::response_filled) return true;
  }
  return false;
}

Vec3 top_of(const runtime::View& view, std::uint32_t tool, const Vec3& up) {
  constexpr double kSteep = 0.8;  // cosine to the upward direction, below which a site is a side
  for (const bool any : {false, true}) {
    double highest = -HUGE_VAL;
    Vec3 top;
    for (std::uint32_t i = 0; i < view.meta->site_count; ++i) {
      const Vec3 at = runtime::vertex(view, i);
      const bool fits = dot(runtime::to_vec(view.sites[i].normal), up) > kSteep && has_own_response(view, tool, i);
      if ((any || fits) && dot(at, up) > highest) {
        highest = dot(at, up);
        top = at;
      }
    }
    if (std::isfinite(highest)) return top;
  }
  return {};
}

}  // namespace

runtime::DeviceFrame place_device(const runtime::View& view, std::uint32_t tool, const FrameOptions& options) {
  runtime::DeviceFrame frame;
  frame.scale = options.scale;
  frame.force_scale = options.force_scale;
  frame.pose = turn_to(options.device_up, options.up);
  if (options.at) {
    frame.pose.translation = *options.at;
    return frame;
  }
  const double gap = options.scale * options.gap;
  frame.pose.translation = top_of(view, tool, options.up);
  // The clearance grows by no more than the way: what remains is overcome step by step.
  for (int k = 0; k < 200; ++k) {
    const double missing = gap - clearance(view, tool, frame, options.tips);
    if (missing <= 1e-6 * view.meta->depth_scale) return frame;
    frame.pose.translation = frame.pose.translation + missing * options.up;
  }
  throw Error(ExitCode::bad_input, "the tool finds no place over the body's top; say where the device is with --at");
}

double clearance(const runtime::View& view, std::uint32_t tool, const runtime::DeviceFrame& frame,
                 const std::vector<Pose>& tips) {
  double least = HUGE_VAL;
  for (const Pose& tip : tips) {
    least = std::fmin(least, runtime::search(view, tool, frame.to_scene(tip)).touch.clearance);
  }
  return least;
}

std::optional<Vec3> axis_named(const std::string& name) {
  const bool minus = !name.empty() && name.front() == '-';
  const std::string letter = minus ? name.substr(1) : name;
  const double sign = minus ? -1 : 1;
  if (letter == "x") return Vec3{sign, 0, 0};
  if (letter == "y") return Vec3{0, sign, 0};
  if (letter == "z") return Vec3{0, 0, sign};
  return std::nullopt;
}

}  // namespace palpate::cli
