// SPDX-License-Identifier: MIT
// Where a tool touches at several places, and how it looks for another: beyond a hollow from those it has.
#pragma once

#include "palpate/overlap.hpp"
#include "palpate/project.hpp"
#include "palpate/tool.hpp"

#include <array>
#include <cmath>

namespace palpate::runtime {

/// What one tool gets from all its contacts.
template <int Most>
struct SeveralTick {
  Vec3 force, torque;  ///< N, N m about the origin of the tool's frame, body frame: the sums
  int touching = 0;
  std::array<Tick, Most> each;  ///< each contact's own, with the share that it has in the sums
  Overlap overlap;
};

/// Where a tool is and touches, for a look for another place.
template <int Most>
struct Places {
  Pose pose;
  int count = 0;
  std::array<Vec3, Most> at;  ///< m, the points c

  /// Of a tick at this pose.
  static Places of(const Pose& pose, const SeveralTick<Most>& tick) {
    Places places;
    places.pose = pose;
    for (const Tick& each : tick.each) {
      if (each.touches()) places.at[static_cast<std::size_t>(places.count++)] = each.body_point;
    }
    return places;
  }
  /// Whether a point is farther than `gap` (m) from all of them.
  [[nodiscard]] bool apart(const Vec3& point, double gap) const {
    for (int k = 0; k < count; ++k) {
      if (length(point - at[static_cast<std::size_t>(k)]) < gap) return false;
    }
    return true;
  }
};

/// Looks for another place where a tool touches.
template <std::uint32_t kFeatures = layout::feature_all>
class PlaceFinder {
public:
  PlaceFinder(const View& view, std::uint32_t tool) : view_(&view), tool_(tool), probe_(view.tool(tool).probe_radius) {
    const double contact = Tip(view, tool).contact(view.meta->depth_scale);
    gap_ = contact > 0 ? contact : view.meta->depth_scale;
  }
  PlaceFinder(const View&&, std::uint32_t) = delete;

  /// m, between the points c of two contacts.
  [[nodiscard]] double gap() const { return gap_; }

  /// What is nearest of all that is apart from the places. Of what is nearer than `reach` (m, 0: overlaps) only what is
  /// another place counts: with a foot of its own, and beyond a hollow. Infinite clearance where there is nothing. Its
  /// `safe` is how far the tool may move before it may touch any of it, whether that counts or not.
  template <int Most>
  [[nodiscard]] Search look(const Places<Most>& places, double reach) const {
    Search search;
    search.pose = places.pose;
    search.touch.clearance = search.touch.safe = HUGE_VAL;
    const layout::ToolRecord& record = view_->tool(tool_);
    if (detail::has_probes<kFeatures>(*view_, tool_)) {
      for (std::uint32_t p = record.first_patch; p < record.first_patch + record.patch_count; ++p) {
        const auto& corner = view_->tool_patches[p].vertex;
        for (int i = 0; i < 3; ++i) {
          ToolPoint on_tool{p, {0, 0, 0}};
          on_tool.weights[i] = 1;
          try_anchor(places, reach, to_vec(view_->tool_vertices[corner[i]].point), on_tool, search.touch);
        }
      }
    } else {
      constexpr int kSamples = 9;
      const int samples = record.axis_length > 0 ? kSamples : 1;
      const double axis = record.axis_length, spacing = samples > 1 ? axis / (samples - 1) : 0;
      for (int i = 0; i < samples; ++i) try_anchor(places, reach, {0, 0, i * spacing}, {}, search.touch);
    }
    return search;
  }

private:
  /// Keeps an anchor's touch if it is nearer to the body than the one kept so far, and apart from all places.
  template <int Most>
  void try_anchor(const Places<Most>& places, double reach, const Vec3& anchor, const ToolPoint& on_tool,
                  ToolTouch& best) const {
    const Vec3 q = places.pose.apply(anchor);
    const auto apart = [&](const Vec3& point) { return places.apart(point, gap_); };
    Location found;
    if (!locate_where<kFeatures>(*view_, q, apart, found)) return;
    const double clearance = found.signed_distance - probe_;
    best.safe = std::fmin(best.safe, std::fmax(0, clearance));
    if (clearance >= best.clearance) return;
    if (clearance < reach) {
      // Its own foot close by, not the rim of a contact that is there nor the far side of a ridge; and a hollow
      // between.
      const Projection foot = project(*view_, found.at, q);
      const bool near = std::fabs(foot.height) <= 1.5 * std::fabs(found.signed_distance) + 0.1 * probe_;
      if (!foot.converged || !near || !apart(foot.point) || foot.height > probe_ + reach) return;
      for (int k = 0; k < places.count; ++k) {
        const Vec3 middle = 0.5 * (places.at[static_cast<std::size_t>(k)] + foot.point);
        if (locate<kFeatures>(*view_, middle, foot.at).signed_distance < 0.05 * gap_) return;
      }
      found.at = foot.at;
      found.point = foot.point;
      found.signed_distance = foot.height;
    }
    best.anchor = anchor;
    best.tool_point = on_tool;
    best.body = found;
    best.clearance = clearance;
  }

  const View* view_;
  std::uint32_t tool_;
  double probe_, gap_;  ///< m
};

/// What a thread of its own saw of a tool that may touch at several places.
template <int Most>
struct SeveralSearch {
  Places<Most> asked;  ///< of which it looked for another
  Search first;        ///< what is nearest, as for a Contact
  Search more;         ///< another place; infinite clearance where there is none
};

/// For a thread that searches while another one makes forces (SeveralContacts::tick with a SeveralSearch). Of a tool
/// that is about to touch it says beforehand what it touches besides.
template <std::uint32_t kFeatures = layout::feature_all, int Most>
inline SeveralSearch<Most> search(const View& view, std::uint32_t tool, const Places<Most>& places) {
  const double reach = 0.5 * (view.tool(tool).probe_radius + view.meta->depth_scale);
  SeveralSearch<Most> result{places, search<kFeatures>(view, tool, places.pose), {}};
  const ToolTouch& nearest = result.first.touch;
  if (places.count == 0 && nearest.clearance < reach) result.asked.at[result.asked.count++] = nearest.body.point;
  result.more.pose = places.pose;
  result.more.touch.clearance = HUGE_VAL;
  if (result.asked.count == 0) return result;
  const Search found = PlaceFinder<kFeatures>(view, tool).look(result.asked, reach);
  if (found.touch.clearance < reach) result.more = found;
  return result;
}

}  // namespace palpate::runtime
