// SPDX-License-Identifier: GPL-3.0-or-later
// Supports under the footprint, and the tool against the undeformed surface.
#include "precompute/bake/reach.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {

using Eigen::Vector3d;

// The footprint is sampled on rings that are projected on the surface.
bool reaches_support(const Body& body, const ContactFrame& frame, double radius) {
  if (body.held(frame.origin)) return true;
  constexpr int rings = 4, spokes = 16;
  for (int ring = 1; ring <= rings; ++ring) {
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const double angle = 2 * std::numbers::pi * spoke / spokes, r = radius * ring / rings;
      const Vector3d wanted = frame.origin + r * (std::cos(angle) * frame.x + std::sin(angle) * frame.y);
      const Vector3d point = body.query->closest(wanted).point;
      if ((point - frame.origin).norm() <= radius * (1 + 1e-9) && body.held(point)) return true;
    }
  }
  return false;
}

double overlap_at_touch(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame) {
  const Eigen::Isometry3d to_tool = touching_pose(vertex, frame).inverse();
  const Eigen::AlignedBox3d box = tool.shape->bounds();
  const Surface& surface = body.query->surface();
  double deepest = 0.0;
  const auto visit = [&](const Vector3d& at) {
    if (box.contains(at)) deepest = std::max(deepest, -tool.shape->distance(at).value);
  };
  for (const auto& t : surface.triangles) {
    const Vector3d a = to_tool * surface.vertices[t[0]], b = to_tool * surface.vertices[t[1]],
                   c = to_tool * surface.vertices[t[2]];
    Eigen::AlignedBox3d bounds(a, a);
    bounds.extend(b).extend(c);
    if (!bounds.intersects(box)) continue;
    // Steps of an eighth of the radius see a wall of any triangle size.
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = std::clamp(static_cast<int>(std::ceil(8 * longest / vertex.curvature_radius)), 1, 400);
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; i + j <= n; ++j) visit(a + (b - a) * i / n + (c - a) * j / n);
    }
  }
  return deepest;
}

bool can_touch_first(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame) {
  return overlap_at_touch(body, tool, vertex, frame) <= 0.2 * vertex.curvature_radius;
}

}  // namespace palpate
