// SPDX-License-Identifier: MIT
// Which point of a tool touches first: spheres and capsules by their axis, mesh tools by probe points.
#pragma once

#include "palpate/point_walk.hpp"

#include <cmath>

namespace palpate::runtime {

/// A point of a tool's skeleton (its axis, or a probe point of a mesh tool) and the body point nearest to it.
struct ToolTouch {
  Vec3 anchor;           ///< m, tool frame
  ToolPoint tool_point;  ///< for mesh tools; a profile's follows from its orientation
  Location body;
  double clearance = 0;  ///< m, from the skin to the body; negative when they overlap
  double safe = 0;       ///< m, the tool may move this far before a search can find a contact, >= 0
};

/// Distance of the farthest skeleton point from the tool frame's origin (m).
template <std::uint32_t kFeatures = layout::feature_all>
inline double skeleton_radius(const View& view, std::uint32_t tool) {
  const layout::ToolRecord& record = view.tool(tool);
  double reach = record.axis_length;
  const bool probes =
      record.kind == static_cast<std::uint32_t>(layout::ToolKind::mesh) && view.tool_vertices != nullptr;
  if ((kFeatures & layout::feature_tool_patches) == 0 || !probes) return reach;
  for (std::uint32_t i = 0; i < record.vertex_count; ++i) {
    reach = std::fmax(reach, length(to_vec(view.tool_vertices[record.first_vertex + i].point)));
  }
  return reach;
}

/// Most that any point of a skeleton of that radius (m) can have moved from one pose to another (m).
inline double skeleton_motion(const Pose& from, const Pose& to, double radius) {
  double turned = 0;
  for (int k = 0; radius > 0 && k < 9; ++k) {
    const double d = to.rotation[k] - from.rotation[k];
    turned += d * d;
  }
  return length(to.translation - from.translation) + std::sqrt(turned) * radius;
}

namespace detail {

/// Nearest point of the axis: a few samples, then alternating projections from the best of them. `first`: nearest to
/// the axis' first point.
template <std::uint32_t kFeatures>
[[gnu::noinline]] inline ToolTouch touch_axis(const View& view, const layout::ToolRecord& tool, const Pose& pose,
                                              const Location& first) {
  constexpr int kSamples = 9, kRefinements = 12;
  const double axis = tool.axis_length, spacing = axis / (kSamples - 1);
  const int samples = axis > 0 ? kSamples : 1;
  PointWalk<kFeatures> walk(view, pose.translation, first);
  double along = 0;
  for (int i = 1; i < samples; ++i) {
    const double at = axis * i / (kSamples - 1);
    if (walk.nearer(pose.apply({0, 0, at}))) along = at;
  }
  ToolTouch best;
  // Between samples the distance falls by at most half their spacing.
  best.safe = std::fmax(0, walk.best().signed_distance - tool.probe_radius - 0.5 * spacing);
  for (int i = 0; samples > 1 && i < kRefinements && walk.best().signed_distance > 0; ++i) {
    const double wanted = pose.along_axis(walk.best().point - pose.translation);
    const double at = wanted > 0 ? (wanted < axis ? wanted : axis) : 0;
    if (std::fabs(at - along) < 1e-9 * axis) break;
    walk.go_back();
    if (!walk.nearer(pose.apply({0, 0, at}))) break;
    along = at;
  }
  best.anchor = {0, 0, along};
  best.body = walk.best();
  best.clearance = best.body.signed_distance - tool.probe_radius;
  return best;
}

/// Corner of a mesh tool's patches that is nearest to a point.
inline ToolPoint nearest_corner(const View& view, const layout::ToolRecord& tool, const Pose& pose, const Vec3& point) {
  ToolPoint nearest;
  double least = HUGE_VAL;
  for (std::uint32_t p = tool.first_patch; p < tool.first_patch + tool.patch_count; ++p) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 gap = pose.apply(to_vec(view.tool_vertices[view.tool_patches[p].vertex[k]].point)) - point;
      if (!(dot(gap, gap) < least)) continue;
      least = dot(gap, gap);
      nearest = {p, {0, 0, 0}};
      nearest.weights[k] = 1;
    }
  }
  return nearest;
}

/// Deepest probe point: a grid over every patch, first the corner nearest to `near`. Between the points nothing is
/// seen: clearance and safe distance hold for them alone, and a body sharper than the grid is met late.
template <std::uint32_t kFeatures>
[[gnu::noinline]] inline ToolTouch touch_probes(const View& view, const layout::ToolRecord& tool, const Pose& pose,
                                                const BodyPoint& near) {
  constexpr int kSteps = 4;
  ToolTouch best;
  best.tool_point = nearest_corner(view, tool, pose, position(view, near));
  Vec3 v[3];
  const auto patch = [&](std::uint32_t p) {
    for (int k = 0; k < 3; ++k) v[k] = to_vec(view.tool_vertices[view.tool_patches[p].vertex[k]].point);
  };
  const auto point = [&](const double(&w)[3]) { return w[0] * v[0] + w[1] * v[1] + w[2] * v[2]; };
  patch(best.tool_point.patch);
  best.anchor = point(best.tool_point.weights);
  const Vec3 first = pose.apply(best.anchor);
  PointWalk<kFeatures> walk(view, first, locate<kFeatures>(view, first, near));
  for (std::uint32_t p = tool.first_patch; p < tool.first_patch + tool.patch_count; ++p) {
    patch(p);
    const Vec3 middle = pose.apply(point({1.0 / 3, 1.0 / 3, 1.0 / 3}));
    double radius = 0;
    for (const Vec3& corner : v) radius = std::fmax(radius, length(pose.apply(corner) - middle));
    if (!walk.may_be_nearer(middle, radius)) continue;
    for (int a = 0; a <= kSteps; ++a) {
      for (int b = 0; a + b <= kSteps; ++b) {
        const ToolPoint at{p, {a / double{kSteps}, b / double{kSteps}, (kSteps - a - b) / double{kSteps}}};
        const Vec3 anchor = point(at.weights);
        if (!walk.nearer(pose.apply(anchor))) continue;
        best.anchor = anchor;
        best.tool_point = at;
      }
    }
  }
  best.body = walk.best();
  best.clearance = best.body.signed_distance - tool.probe_radius;
  best.safe = std::fmax(0, best.clearance);
  return best;
}

template <std::uint32_t kFeatures>
inline bool has_probes(const View& view, std::uint32_t tool) {
  const bool mesh = view.tool(tool).kind == static_cast<std::uint32_t>(layout::ToolKind::mesh);
  return (kFeatures & layout::feature_tool_patches) != 0 && mesh && view.tool_patches != nullptr;
}

}  // namespace detail

/// The tool point that is nearest to the body, or deepest in it. `near` as in locate(): where the last search saw it.
template <std::uint32_t kFeatures = layout::feature_all>
inline ToolTouch find_touch(const View& view, std::uint32_t tool, const Pose& pose, const BodyPoint& near = {}) {
  const layout::ToolRecord& record = view.tool(tool);
  if (detail::has_probes<kFeatures>(view, tool)) return detail::touch_probes<kFeatures>(view, record, pose, near);
  return detail::touch_axis<kFeatures>(view, record, pose, locate<kFeatures>(view, pose.translation, near));
}

/// The same for one whose skeleton is known to be outside the body, and may be far from it. `radius` (m): of a ball
/// about the tool's origin that holds its skin. Where nothing of the body is nearer to the ball than half as far as the
/// point `near`, clearance and safe distance are that half, less than they might be, and nothing else is looked for:
/// most of the way a free tool looks at a few boxes.
template <std::uint32_t kFeatures = layout::feature_all>
[[gnu::noinline]] inline ToolTouch find_touch_ahead(const View& view, std::uint32_t tool, const Pose& pose,
                                                    const BodyPoint& near, double radius) {
  const double gap = length(pose.translation - position(view, near)) - radius;
  if (!(gap > 0)) return find_touch<kFeatures>(view, tool, pose, near);
  const double within = radius + 0.5 * gap;
  Location found;
  if (!locate_where<kFeatures>(view, pose.translation, detail::Anywhere{}, found, within * within)) {
    ToolTouch touch;
    touch.body.at = near;
    touch.clearance = touch.safe = 0.5 * gap;
    return touch;
  }
  const layout::ToolRecord& record = view.tool(tool);
  if (detail::has_probes<kFeatures>(view, tool)) return detail::touch_probes<kFeatures>(view, record, pose, found.at);
  return detail::touch_axis<kFeatures>(view, record, pose, found);
}

/// What a search found, and where the tool was then: of one view and one tool, for contacts of these alone.
struct Search {
  Pose pose;
  ToolTouch touch;
};

/// For a thread that searches while another one makes forces (Contact::tick with a Search).
template <std::uint32_t kFeatures = layout::feature_all>
inline Search search(const View& view, std::uint32_t tool, const Pose& pose) {
  return {pose, find_touch<kFeatures>(view, tool, pose)};
}

/// Where the stem of a profile begins: arc length from the tip's pole (m).
inline double profile_stem(const layout::ToolRecord& tool) { return tool.probe_radius * 1.5707963267948966; }

/// Where on its profile a tool touches: arc length from the tip's pole (m), for an axis point `along` (m) and
/// the cosine between the body's normal and the tool's z axis. A contact that lasts runs there (BasicRest).
inline double profile_meridian(const layout::ToolRecord& tool, double along, double cosine) {
  const double stem = profile_stem(tool);
  if (along > 0) return stem + along;
  const double angle = std::acos(cosine > 1 ? 1 : cosine > 0 ? cosine : 0);
  return std::fmin(tool.probe_radius * angle, stem);
}

/// The segment of a profile that holds a meridian; beyond the ends, the end.
inline ToolPoint profile_point(const View& view, const layout::ToolRecord& tool, double meridian) {
  ToolPoint at;
  at.patch = tool.first_patch;
  if (view.tool_patches == nullptr) return at;
  for (std::uint32_t p = tool.first_patch; p < tool.first_patch + tool.patch_count; ++p) {
    const auto& corner = view.tool_patches[p].vertex;
    const double low = view.tool_vertices[corner[0]].meridian, high = view.tool_vertices[corner[1]].meridian;
    at.patch = p;
    double share = high > low ? (meridian - low) / (high - low) : 0;
    share = share > 0 ? (share < 1 ? share : 1) : 0;
    at.weights[0] = 1 - share;
    at.weights[1] = share;
    if (meridian <= high) break;
  }
  return at;
}

}  // namespace palpate::runtime
