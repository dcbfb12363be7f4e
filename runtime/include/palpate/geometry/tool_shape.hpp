// SPDX-License-Identifier: MIT
// Shapes of tools as sphere-swept cores: the core point that is nearest to the body, and how a contact's point runs
// over the core.
#pragma once

#include "palpate/geometry/closest_point.hpp"
#include "palpate/math/pose.hpp"

#include <cmath>

namespace palpate::runtime {

/// A point of a tool as its responses are sampled: an index into the file's tool patches and weights of that patch's
/// vertices. A tool with one vertex has patch 0 and weights {1, 0, 0}.
struct ToolPoint {
  std::uint32_t patch = 0;
  double weights[3] = {1, 0, 0};
};

/// A point of a tool's core: a sphere's centre, a point of a profile's axis or of a mesh tool's patches.
struct CorePoint {
  Vec3 point;  ///< m, tool frame
  ToolPoint at;
};

/// The core point that is nearest to the body, or deepest in it.
struct ToolTouch {
  CorePoint core;
  Location body;
  double clearance = 0;  ///< m, from the skin to the body; negative where they overlap
  double safe = 0;       ///< m, the tool may move by this much before a search can find an overlap, >= 0
};

/// A tool of a file. The skin lies `skin()` metres from the core. The tip points along -z of the tool's frame and the
/// handle along +z; the origin is the centre of a sphere or of a profile's tip, and the middle of a punch's face.
template <std::uint32_t kFeatures = layout::feature_all>
class ToolShape {
  static constexpr bool kPatches = (kFeatures & layout::feature_tool_patches) != 0;

public:
  ToolShape(const View& view, std::uint32_t tool) : view_(&view), record_(&view.tool(tool)) {
    reach_ = record_->axis_length;
    if constexpr (kPatches) {
      for (std::uint32_t i = 0; is_mesh() && i < record_->vertex_count; ++i) {
        reach_ = larger(reach_, length(to_vec(view.tool_vertices[record_->first_vertex + i].point)));
      }
    }
  }

  /// m, from the core to the skin; 0 for a punch and a mesh.
  [[nodiscard]] double skin() const { return record_->probe_radius; }
  /// m, of the core's farthest point from the tool's origin.
  [[nodiscard]] double reach() const { return reach_; }
  /// m, of the skin's farthest point from the tool's origin.
  [[nodiscard]] double extent() const { return reach_ + skin(); }

  /// A segment with round ends, such as a capsule's stem: a contact's point runs along it.
  [[nodiscard]] bool is_profile() const {
    return record_->kind == static_cast<std::uint32_t>(layout::ToolKind::profile) && record_->axis_length > 0;
  }
  /// Triangles that are sampled at their corners: a contact's point runs over them.
  [[nodiscard]] bool is_mesh() const {
    return patched() && record_->kind == static_cast<std::uint32_t>(layout::ToolKind::mesh);
  }

  /// The core point nearest to the body at a pose. `surface`: the view whose vertices and search tree say where the
  /// body is now. `near`: any point of the surface, the nearer the faster.
  [[nodiscard]] ToolTouch touch(const View& surface, const Pose& pose, const BodyPoint& near) const {
    return is_mesh() ? touch_mesh(surface, pose, near) : touch_axis(surface, pose, near);
  }

  /// Next core point of a contact that is at `from`, at most `reach` (m) over the core, while its foot (body frame) is `foot`
  /// and the unit normal is n. A profile's point goes to the axis point nearest to the body; over a mesh it runs down
  /// along -n.
  [[nodiscard]] CorePoint advance(const CorePoint& from, const Pose& pose, const Location& foot, const Vec3& n,
                                  double reach) const {
    if (!(reach > 0)) return from;
    if (is_mesh()) return run_down(from, pose.unrotate(-n), reach);
    CorePoint to = from;
    if (!is_profile()) return to;
    to.point.z = nearest_on_axis(from.point.z, pose, foot, reach);
    if (!patched()) return to;
    const double last = meridian_of(from.at), meridian = meridian_at(to.point.z, dot(pose.axis(), n));
    to.at = profile_point(last + clamped(meridian - last, -reach, reach));
    return to;
  }

  /// The sampled point of a core point at the first touch, with n the body's normal there.
  [[nodiscard]] ToolPoint sampled_point(const CorePoint& core, const Pose& pose, const Vec3& n) const {
    if (!is_profile() || !patched()) return core.at;
    return profile_point(meridian_at(core.point.z, dot(pose.axis(), n)));
  }

  /// Calls use(core) for core points spread over the tool: the centre of a sphere, five points of an axis, corners and
  /// middles of a mesh's patches.
  template <class Use>
  void for_each_sample(const Use& use) const {
    if (!is_mesh()) {
      const int samples = record_->axis_length > 0 ? 5 : 1;
      CorePoint core;
      core.at.patch = record_->first_patch;
      for (int i = 0; i < samples; ++i) {
        core.point.z = samples > 1 ? i * double{record_->axis_length} / (samples - 1) : 0;
        use(core);
      }
      return;
    }
    constexpr double kWeights[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1.0 / 3, 1.0 / 3, 1.0 / 3}};
    for (std::uint32_t p = record_->first_patch; p < record_->first_patch + record_->patch_count; ++p) {
      for (const auto& w : kWeights) {
        use(CorePoint{w[0] * corner(p, 0) + w[1] * corner(p, 1) + w[2] * corner(p, 2), {p, {w[0], w[1], w[2]}}});
      }
    }
  }

private:
  [[nodiscard]] bool patched() const { return kPatches && view_->tool_patches != nullptr; }

  /// A search that goes from core point to core point. Points that cannot be nearer
  /// than the best so far cost a look at a few boxes.
  class Walk {
  public:
    Walk(const View& surface, const Vec3& q, const BodyPoint& near)
        : surface_(surface), best_(closest_point<kFeatures>(surface, q, near)), best_at_(q) {}
    [[nodiscard]] const Location& best() const { return best_; }

    /// Whether some point within `radius` (m) of q may be nearer than the best.
    [[nodiscard]] bool may_be_nearer(const Vec3& q, double radius) const {
      Location found;
      return look(q, radius, found) && found.signed_distance - radius < best_.signed_distance;
    }
    /// Makes q the best point where it is nearer to the body, or deeper in it.
    bool nearer(const Vec3& q) {
      Location found;
      if (!look(q, 0, found) || found.signed_distance >= best_.signed_distance) return false;
      best_ = found;
      best_at_ = q;
      return true;
    }

  private:
    /// A ball about the best point is free of the surface. So a point inside the body has the surface within
    /// way - best, a nearer one within best: beyond both nothing is of interest.
    bool look(const Vec3& q, double radius, Location& found) const {
      const double best = best_.signed_distance;
      if (!(best > 0)) {
        found = closest_point<kFeatures>(surface_, q, best_.at);
        return true;
      }
      const double reach = larger(best + radius, length(q - best_at_) - best + radius);
      return closest_point_where<kFeatures>(surface_, q, AnyPoint(), (1 + 1e-9) * reach, found);
    }
    const View& surface_;
    Location best_;
    Vec3 best_at_;
  };

  /// Samples of the axis, then alternating projections from the best of them.
  [[nodiscard]] ToolTouch touch_axis(const View& surface, const Pose& pose, const BodyPoint& near) const {
    constexpr int kSamples = 9, kRefinements = 12;
    const double axis = record_->axis_length, spacing = axis / (kSamples - 1);
    Walk walk(surface, pose.translation, near);
    double along = 0;
    for (int i = 1; axis > 0 && i < kSamples; ++i) {
      if (walk.nearer(pose.apply({0, 0, i * spacing}))) along = i * spacing;
    }
    ToolTouch touch;
    // Between samples the distance falls by at most half their spacing.
    touch.safe = larger(0, walk.best().signed_distance - skin() - 0.5 * spacing);
    for (int i = 0; axis > 0 && i < kRefinements && walk.best().signed_distance > 0; ++i) {
      const double at = smaller(larger(pose.unapply(walk.best().point).z, 0.0), axis);
      if (std::fabs(at - along) < 1e-9 * axis || !walk.nearer(pose.apply({0, 0, at}))) break;
      along = at;
    }
    touch.core.point = {0, 0, along};
    touch.core.at.patch = record_->first_patch;
    touch.body = walk.best();
    touch.clearance = touch.body.signed_distance - skin();
    return touch;
  }

  /// Deepest point of a grid over every patch. A body feature finer than the grid is met late.
  [[nodiscard]] PALPATE_NOINLINE ToolTouch touch_mesh(const View& surface, const Pose& pose,
                                                      const BodyPoint& near) const {
    constexpr int kSteps = 4;
    ToolTouch touch;
    const std::uint32_t first = record_->first_patch, end = first + record_->patch_count;
    touch.core.at = {first, {1, 0, 0}};
    touch.core.point = corner(first, 0);
    Walk walk(surface, pose.apply(touch.core.point), near);
    for (std::uint32_t p = first; p < end; ++p) {
      const Vec3 v[3] = {corner(p, 0), corner(p, 1), corner(p, 2)};
      const Vec3 middle = (1.0 / 3) * (v[0] + v[1] + v[2]);
      double radius = 0;
      for (const Vec3& each : v) radius = larger(radius, length(each - middle));
      if (!walk.may_be_nearer(pose.apply(middle), radius)) continue;
      for (int a = 0; a <= kSteps; ++a) {
        for (int b = 0; a + b <= kSteps; ++b) {
          const ToolPoint at{p, {a / double{kSteps}, b / double{kSteps}, (kSteps - a - b) / double{kSteps}}};
          const Vec3 point = at.weights[0] * v[0] + at.weights[1] * v[1] + at.weights[2] * v[2];
          if (walk.nearer(pose.apply(point))) touch.core = {point, at};
        }
      }
    }
    touch.body = walk.best();
    touch.clearance = touch.body.signed_distance - skin();
    touch.safe = larger(0, touch.clearance);
    return touch;
  }

  [[nodiscard]] Vec3 corner(std::uint32_t patch, int k) const {
    return to_vec(view_->tool_vertices[view_->tool_patches[patch].vertex[k]].point);
  }

  /// m along the axis, at most `reach` from `from`. The projection of the foot lessens the distance, but along an axis that is
  /// nearly parallel to the body by the square of the slope alone. A step as for a body with a curvature radius of the
  /// tool's extent is tried first; where it goes too far the secant of the slopes gives the way.
  [[nodiscard]] PALPATE_NOINLINE double nearest_on_axis(double from, const Pose& pose, const Location& foot,
                                                        double reach) const {
    const double low = larger(from - reach, 0.0), high = smaller(from + reach, double{record_->axis_length});
    const Vec3 axis = pose.axis();
    const double falls = dot(pose.apply({0, 0, from}) - foot.point, axis), gap = foot.signed_distance;  // m
    const double projection = clamped(from - falls, low, high);
    if (!(gap > 0)) return projection;
    const double ahead = clamped(from - falls * (extent() / gap), low, high);
    if (!(std::fabs(ahead - projection) > 0)) return projection;
    const Vec3 there = pose.apply({0, 0, ahead});
    const Location found = local_closest_point(*view_, foot.at, there);
    const double slope = falls / gap, beyond = dot(there - found.point, axis) / found.signed_distance;
    if (!(found.signed_distance > 0)) return projection;
    if (slope * beyond >= 0) return ahead;
    const double secant = from + (ahead - from) * slope / (slope - beyond);
    return std::fabs(secant - from) > std::fabs(projection - from) ? secant : projection;
  }

  /// Arc length (m) from the pole of a profile's tip to the point that faces the body. `along`: of the axis point (m);
  /// `cosine`: between the body's normal and the tool's axis.
  [[nodiscard]] double meridian_at(double along, double cosine) const {
    const double stem = skin() * 0.25 * kFullTurn;
    if (along > 0) return stem + along;
    return smaller(skin() * std::acos(smaller(larger(cosine, 0.0), 1.0)), stem);
  }
  [[nodiscard]] double meridian_of(const ToolPoint& at) const {
    const auto& vertex = view_->tool_patches[at.patch].vertex;
    return at.weights[0] * view_->tool_vertices[vertex[0]].meridian +
           at.weights[1] * view_->tool_vertices[vertex[1]].meridian;
  }
  /// The segment of the profile that holds a meridian; beyond the ends, the end.
  [[nodiscard]] ToolPoint profile_point(double meridian) const {
    ToolPoint at;
    at.patch = record_->first_patch;
    for (std::uint32_t p = record_->first_patch; p < record_->first_patch + record_->patch_count; ++p) {
      const auto& vertex = view_->tool_patches[p].vertex;
      const double low = view_->tool_vertices[vertex[0]].meridian, high = view_->tool_vertices[vertex[1]].meridian;
      at.patch = p;
      const double share = high > low ? smaller(larger((meridian - low) / (high - low), 0.0), 1.0) : 0;
      at.weights[0] = 1 - share;
      at.weights[1] = share;
      if (meridian <= high) break;
    }
    return at;
  }

  /// From a core point down along the unit direction `down` (tool frame), by at most `reach` (m): straight to the
  /// lowest corner of its patch, and from there along edges.
  [[nodiscard]] PALPATE_NOINLINE CorePoint run_down(CorePoint from, const Vec3& down, double reach) const {
    constexpr int kMostCorners = 4;  // passed in a tick
    for (int turn = 0; turn < kMostCorners; ++turn) {
      for (int k = 0; k < 3; ++k) {
        if (from.at.weights[k] == 1) {
          from.at = around_corner(from.at, k, down);
          break;
        }
      }
      const int lowest = lowest_corner(from.at.patch, down);
      const Vec3 to = corner(from.at.patch, lowest), way = to - from.point;
      const double size = length(way), falls = dot(way, down);
      if (!(falls > 1e-9 * size)) break;
      // A body with a curvature radius of `extent` bends away from a facet: the deepest point lies where its slope
      // equals the facet's, falls / size.
      const double step = smaller(reach, kCurvature * reach_ * falls / size), share = step / size;
      if (share < 1) {
        for (int k = 0; k < 3; ++k) from.at.weights[k] *= 1 - share;
        from.at.weights[lowest] += share;
        from.point = from.point + share * way;
        break;
      }
      for (int k = 0; k < 3; ++k) from.at.weights[k] = k == lowest ? 1 : 0;
      from.point = to;
      reach -= size;
    }
    return from;
  }
  [[nodiscard]] int lowest_corner(std::uint32_t patch, const Vec3& down) const {
    int best = 0;
    for (int k = 1; k < 3; ++k) {
      if (dot(corner(patch, k), down) > dot(corner(patch, best), down)) best = k;
    }
    return best;
  }
  /// The point at corner `k` of a patch, seen from the patch of that corner that reaches lowest.
  [[nodiscard]] ToolPoint around_corner(const ToolPoint& at, int k, const Vec3& down) const {
    const std::uint32_t shared = view_->tool_patches[at.patch].vertex[k];
    ToolPoint best = at;
    double most = dot(corner(at.patch, k), down);
    for (std::uint32_t p = record_->first_patch; p < record_->first_patch + record_->patch_count; ++p) {
      for (int j = 0; j < 3; ++j) {
        if (view_->tool_patches[p].vertex[j] != shared) continue;
        const double along = dot(corner(p, lowest_corner(p, down)), down);
        if (!(along > most)) continue;
        most = along;
        best = {p, {0, 0, 0}};
        best.weights[j] = 1;
      }
    }
    return best;
  }

  static constexpr double kCurvature = 1;  // of the core's reach: the body's radius of curvature that run_down expects

  const View* view_;
  const layout::ToolRecord* record_;
  double reach_ = 0;  ///< m
};

}  // namespace palpate::runtime
