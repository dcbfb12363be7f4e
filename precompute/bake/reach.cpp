// SPDX-License-Identifier: GPL-3.0-or-later
// Supports under the footprint, and the tool against the undeformed surface.
#include "precompute/bake/reach.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace palpate::bake {

using Eigen::Vector3d;

namespace {

// Points of the surface (tool frame) that the tool could meet while it is lifted by up to `lift` along `out`.
std::vector<Vector3d> swept_surface(const solve::ContactCase& contact, const Eigen::Isometry3d& to_tool,
                                    const Vector3d& out, double lift) {
  Eigen::AlignedBox3d box = contact.tool.shape->bounds();
  const Eigen::AlignedBox3d lifted(box.min() + lift * out, box.max() + lift * out);
  box.extend(lifted);
  std::vector<Vector3d> points;
  const Surface& surface = contact.body.query->surface();
  for (const auto& t : surface.triangles) {
    const Vector3d a = to_tool * surface.vertices[t[0]], b = to_tool * surface.vertices[t[1]],
                   c = to_tool * surface.vertices[t[2]];
    Eigen::AlignedBox3d bounds(a, a);
    bounds.extend(b).extend(c);
    if (!bounds.intersects(box)) continue;
    // Steps of an eighth of the radius see a wall of any triangle size.
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = std::clamp(static_cast<int>(std::ceil(8 * longest / contact.vertex.curvature_radius)), 1, 400);
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; i + j <= n; ++j) {
        const Vector3d at = a + (b - a) * i / n + (c - a) * j / n;
        if (box.contains(at)) points.push_back(at);
      }
    }
  }
  return points;
}

double overlap(const tool::ToolShape& shape, const std::vector<Vector3d>& points, const Vector3d& shift) {
  double deepest = 0.0;
  for (const Vector3d& at : points) deepest = std::max(deepest, -shape.distance(at - shift).value);
  return deepest;
}

// The footprint is sampled on rings that are projected on the surface.
bool footprint_held(const Body& body, const ContactFrame& frame, double radius) {
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

// The undeformed held surface under the deepest tool; a sliver of overlap is below what the contact gates see.
bool sinks_into_held(const solve::ContactCase& contact, double depth) {
  Eigen::Isometry3d pose = tool::touching_pose(contact.vertex, contact.frame);
  pose.translation() -= depth * contact.frame.n;
  const double sliver = 0.02 * tool::contact_radius(contact.vertex, depth);
  const std::vector<Vector3d> points = swept_surface(contact, pose.inverse(), Vector3d::UnitZ(), 0.0);
  // The distance to a mesh costs far more than the look at a support, and few points are held.
  return std::any_of(points.begin(), points.end(), [&](const Vector3d& at) {
    return contact.body.held(pose * at) && contact.tool.shape->distance(at).value < -sliver;
  });
}

}  // namespace

bool reaches_support(const solve::ContactCase& contact, double depth) {
  return footprint_held(contact.body, contact.frame, tool::contact_radius(contact.vertex, depth)) ||
         sinks_into_held(contact, depth);
}

TouchReach touch_reach(const solve::ContactCase& contact) {
  const auto& [body, tool, vertex, frame] = contact;
  const Eigen::Isometry3d to_tool = tool::touching_pose(vertex, frame).inverse();
  const Vector3d out = to_tool.linear() * frame.n;
  const double limit = 2 * vertex.curvature_radius, resolution = 1e-3 * vertex.curvature_radius;
  const std::vector<Vector3d> points = swept_surface(contact, to_tool, out, limit);
  TouchReach reach;
  double left = reach.overlap = overlap(*tool.shape, points, Vector3d::Zero());
  while (left > resolution && reach.lift <= limit) {
    reach.lift += left;
    left = overlap(*tool.shape, points, reach.lift * out);
  }
  reach.blocked = left > resolution;
  return reach;
}

bool can_touch_first(const solve::ContactCase& contact) {
  const TouchReach reach = touch_reach(contact);
  return !reach.blocked && reach.overlap <= 0.2 * contact.vertex.curvature_radius;
}

bool can_be_pressed(const solve::ContactCase& contact, double depth) {
  return !reaches_support(contact, depth) && can_touch_first(contact);
}

}  // namespace palpate::bake
