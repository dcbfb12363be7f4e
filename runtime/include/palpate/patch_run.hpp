// SPDX-License-Identifier: MIT
// How p runs over the patches of a mesh tool to where it lies deepest.
#pragma once

#include "palpate/tool.hpp"

#include <cmath>

namespace palpate::runtime {

/// A point of a tool.
struct ToolPlace {
  ToolPoint at;
  Vec3 point;  ///< m, tool frame
};

namespace detail {

/// The corner of a patch that is farthest along a direction.
inline int farthest_corner(const View& view, const layout::ToolPatch& patch, const Vec3& down) {
  int best = 0;
  double most = -HUGE_VAL;
  for (int k = 0; k < 3; ++k) {
    const double along = dot(to_vec(view.tool_vertices[patch.vertex[k]].point), down);
    if (!(along > most)) continue;
    most = along;
    best = k;
  }
  return best;
}

/// Of a point at corner `k` of a patch: the same seen from that patch of the corner that goes on farthest along a
/// direction.
inline ToolPoint around_corner(const View& view, const layout::ToolRecord& tool, const ToolPoint& at, int k,
                               const Vec3& down) {
  const std::uint32_t corner = view.tool_patches[at.patch].vertex[k];
  ToolPoint best = at;
  double most = dot(to_vec(view.tool_vertices[corner].point), down);
  for (std::uint32_t p = tool.first_patch; p < tool.first_patch + tool.patch_count; ++p) {
    const layout::ToolPatch& patch = view.tool_patches[p];
    for (int j = 0; j < 3; ++j) {
      if (patch.vertex[j] != corner) continue;
      const int far = farthest_corner(view, patch, down);
      const double along = dot(to_vec(view.tool_vertices[patch.vertex[far]].point), down);
      if (!(along > most)) continue;
      most = along;
      best = {p, {0, 0, 0}};
      best.weights[j] = 1;
    }
  }
  return best;
}

}  // namespace detail

/// From a place on a mesh tool down along a direction (tool frame, unit), by `reach` (m) over the tool at most:
/// straight to the corner of its patch that is lowest, and from there along edges, so ever lower and without a gap.
/// Where the body is round the slope ends before a corner: it is gone by its sine times `curvature` (m) at most.
[[nodiscard, gnu::noinline]] inline ToolPlace run_down(const View& view, const layout::ToolRecord& tool,
                                                       ToolPlace place, const Vec3& down, double reach,
                                                       double curvature) {
  constexpr int kMostCorners = 4;  // in a tick; more than that the skin does not go
  for (int turn = 0; turn < kMostCorners; ++turn) {
    for (int k = 0; k < 3; ++k) {
      if (place.at.weights[k] == 1) {
        place.at = detail::around_corner(view, tool, place.at, k, down);
        break;
      }
    }
    const int corner = detail::farthest_corner(view, view.tool_patches[place.at.patch], down);
    const Vec3 to = to_vec(view.tool_vertices[view.tool_patches[place.at.patch].vertex[corner]].point);
    const Vec3 way = to - place.point;
    const double size = length(way), falls = dot(way, down);
    if (!(falls > 1e-9 * size)) break;
    const double step = std::fmin(reach, falls / size * curvature), share = step / size;
    if (share < 1) {
      for (int k = 0; k < 3; ++k) place.at.weights[k] *= 1 - share;
      place.at.weights[corner] += share;
      place.point = place.point + share * way;
      break;
    }
    for (int k = 0; k < 3; ++k) place.at.weights[k] = k == corner ? 1 : 0;
    place.point = to;
    reach -= size;
  }
  return place;
}

/// Where p of a mesh tool is to be in each tick; of a program without patches nothing.
template <std::uint32_t kFeatures>
class PatchRun {
  static constexpr bool kPatches = (kFeatures & layout::feature_tool_patches) != 0;

public:
  PatchRun(const View& view, std::uint32_t tool) {
    if constexpr (kPatches) {
      runs_ = detail::has_probes<kFeatures>(view, tool);
      skin_ = skeleton_radius<kFeatures>(view, tool);
    }
  }

  /// The tool is a mesh.
  [[nodiscard]] bool runs() const {
    if constexpr (kPatches) return runs_;
    return false;
  }
  [[nodiscard]] ToolPlace next() const {
    if constexpr (kPatches) return next_;
    return {};
  }

  void begin(const Pose& pose, const ToolPlace& place) {
    if constexpr (kPatches) {
      for (int k = 0; k < 2; ++k) axis_[k] = pose.rotate(kAxes[k]);
      next_ = place;
      lowest_ = {};
    }
  }

  /// In this tick the tool came to a pose, p from a place by `way` (m); n is n(c), `size` (m) a contact's. Several
  /// times as far as the skin went p may run: a facet that is parallel to the body is as low from corner to corner, and
  /// what the next is lower when p comes there is lost. In fast motions less, lest it leap.
  [[gnu::noinline]] void tick(const View& view, std::uint32_t tool, const ToolPlace& place, const Pose& pose,
                              const Vec3& way, const Vec3& n, double size) {
    if constexpr (kPatches) {
      constexpr double kTimes = 24, kSizes = 16;
      double turn = 0;
      for (int k = 0; k < 2; ++k) {
        const Vec3 axis = pose.rotate(kAxes[k]);
        turn = std::fmax(turn, length(axis - axis_[k]));
        axis_[k] = axis;
      }
      next_ = place;
      const double skin = length(way) + skin_ * turn;
      const Vec3 down = inverse(pose).rotate(-1 * n), other = down - lowest_;
      // To see that p is lowest where it is takes a look at all patches: not again for the same direction.
      if (!(skin > 0) || dot(other, other) < 1e-18) return;
      const double reach = std::fmin(kTimes * skin, 0.25 * size + 3 * skin);
      next_ = run_down(view, view.tools[tool], place, down, reach, kSizes * size);
      lowest_ = length(next_.point - place.point) > 0 ? Vec3{} : down;
    }
  }

  /// Turns the tool's pose of the last tick by that of `by`.
  void rebase(const Pose& by) {
    if constexpr (kPatches) {
      for (Vec3& axis : axis_) axis = by.rotate(axis);
    }
  }

private:
  static constexpr Vec3 kAxes[2] = {{0, 0, 1}, {1, 0, 0}};

  detail::If<kPatches, bool> runs_ = {};
  detail::If<kPatches, double> skin_ = {};   ///< m, of the tool's skeleton about its origin
  detail::If<kPatches, Vec3[2]> axis_ = {};  ///< of the tool in the last tick
  detail::If<kPatches, ToolPlace> next_ = {};
  detail::If<kPatches, Vec3> lowest_ = {};  ///< the direction in which p is known to be lowest where it is; else 0
};

}  // namespace palpate::runtime
