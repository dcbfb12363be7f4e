// SPDX-License-Identifier: MIT
// A tool while it is free, and how a contact begins.
#pragma once

#include "palpate/body/body.hpp"
#include "palpate/geometry/sweep.hpp"

#include <cmath>

namespace palpate::runtime {

/// A search for a contact, and the pose (body frame) at which it was made. It is of use to contacts of the same file
/// and tool alone.
struct Search {
  Pose pose;
  ToolTouch touch;
};

/// Returns the tool's core point that is nearest to the body, or deepest in it, at a pose of the tool.
/// `view`: the body as baked. `tool`: an index below view.meta->tool_count.
/// `pose`: of the tool in the frame of that body. A body that has moved has it from in_body(tool,
/// body.surface_frame()). `near`: any point of the surface; the point that the last search found makes the next one
/// fast. For any thread: it reads the view alone.
template <std::uint32_t kFeatures = layout::feature_all>
inline Search search(const View& view, std::uint32_t tool, const Pose& pose, const BodyPoint& near = {}) {
  return {pose, ToolShape<kFeatures>(view, tool).touch(view, pose, near)};
}

/// The place of a search, measured at another pose by a walk over the surface from `near`.
template <std::uint32_t kFeatures>
inline ToolTouch local_touch(const View& view, const ToolShape<kFeatures>& shape, const Search& search,
                             const Pose& pose, const BodyPoint& near) {
  ToolTouch touch = search.touch;
  touch.body = local_closest_point(view, near, pose.apply(touch.core.point));
  touch.clearance = touch.body.signed_distance - shape.skin();
  touch.safe = 0;
  return touch;
}

/// A free tool: where it was last, and how far it may go before it has to be searched for again.
class FreeTool {
public:
  void reset() { known_ = false; }

  /// Looks for the first touch on the way to `tool` (world). `most` (m): a tool that went farther was put there, and is
  /// looked for there alone. `gap` (m): clearance at which a touch is found. The result's pose is that at the touch, in
  /// the frame of body.surface().
  template <std::uint32_t kFeatures, class Body>
  Sweep advance(const ToolShape<kFeatures>& shape, const Pose& tool, const Body& body, const Search* latest,
                double most, double gap) {
    const Pose to = in_body(tool, body.surface_frame());
    const double surface_travel = body.travel();
    const double way = travel(pose_, to, shape.extent()) + std::fabs(surface_travel - surface_travel_);
    Sweep found;
    found.pose = to;
    if (known_ && way < safe_) {
      pose_ = to;
      surface_travel_ = surface_travel;
      safe_ -= way;
      return found;
    }
    const View& surface = body.surface();
    if (latest != nullptr && travel(latest->pose, to, shape.extent()) < latest->touch.safe) {
      return remain(to, surface_travel, latest->touch, 0), found;
    }
    const auto search = [&](const Pose& pose, const BodyPoint& near) {
      return latest != nullptr ? local_touch(surface, shape, *latest, pose, near) : shape.touch(surface, pose, near);
    };
    const BodyPoint near = latest != nullptr ? latest->touch.body.at : near_;
    if (known_ && way < most) {
      // A core that was outside by its skin can be inside by no more than the rest of the way; where the surface folds
      // over itself a search may say otherwise.
      const auto outside = [&](const Pose& pose, const BodyPoint& from) {
        ToolTouch touch = search(pose, from);
        if (searched_ && latest == nullptr && touch.body.signed_distance < 0 &&
            shape.skin() - touch.body.signed_distance > way) {
          touch.body.signed_distance = -touch.body.signed_distance;
          touch.clearance = touch.body.signed_distance - shape.skin();
          touch.safe = larger(0, touch.clearance);
        }
        return touch;
      };
      found = sweep(pose_, to, outside(pose_, near), shape.extent(), gap, outside);
      const bool whole = found.share == 1;
      if (!found.touches) remain(whole ? to : found.pose, surface_travel, found.touch, whole ? found.touch.safe : 0);
    } else {
      found.touch = search(to, near);
      found.touches = found.touch.clearance < 0;
      if (!found.touches) remain(to, surface_travel, found.touch, latest == nullptr ? found.touch.safe : 0);
    }
    return found;
  }

  /// The tool left a contact at this pose (world).
  template <class Body>
  void leave(const Pose& tool, const Body& body, const BodyPoint& near) {
    known_ = true;
    searched_ = false;
    pose_ = in_body(tool, body.surface_frame());
    surface_travel_ = body.travel();
    near_ = near;
    safe_ = 0;
  }

private:
  void remain(const Pose& at, double surface_travel, const ToolTouch& touch, double safe) {
    known_ = searched_ = true;
    pose_ = at;
    surface_travel_ = surface_travel;
    near_ = touch.body.at;
    safe_ = safe;
  }

  bool known_ = false;     ///< whether the tool was free at pose_
  bool searched_ = false;  ///< whether a search of the whole tool found so, and not the end of a contact at one point
  Pose pose_;           ///< in the frame of body.surface()
  double surface_travel_ = 0;
  BodyPoint near_;
  double safe_ = 0;  ///< m, from pose_
};

}  // namespace palpate::runtime
