// SPDX-License-Identifier: MIT
// Which of many points is nearest to the body: what is known of one spares most of the search for the next.
#pragma once

#include "palpate/locate.hpp"

#include <cmath>

namespace palpate::runtime {

/// Goes from point to point. Of a point that is known to be outside, with nothing of the body within some distance, the
/// next need only be searched for what is nearer than the best so far, and as far as it takes to know on which side it
/// is: most are seen off by a look at a few boxes.
template <std::uint32_t kFeatures = layout::feature_all>
class PointWalk {
public:
  /// The first point and what is nearest to it.
  PointWalk(const View& view, const Vec3& q, const Location& there) : view_(&view), best_(there), best_at_(q) {
    go_back();
  }

  /// What is nearest to the best point.
  [[nodiscard]] const Location& best() const { return best_; }

  /// Goes on from the best point.
  void go_back() {
    at_ = best_at_;
    free_ = best_.signed_distance;
  }

  /// Whether a point is nearer to the body than the best, or deeper in it: it is the best then.
  bool nearer(const Vec3& q) {
    Location found;
    if (!look(q, 0, found) || found.signed_distance >= best_.signed_distance) return false;
    best_ = found;
    best_at_ = q;
    return true;
  }

  /// Whether any point within a radius (m) about q may be.
  bool may_be_nearer(const Vec3& q, double radius) {
    Location found;
    return look(q, radius, found) && found.signed_distance - radius < best_.signed_distance;
  }

private:
  /// What is nearest to q; false where nothing within a radius about that is nearer than the best. Out of line: what is
  /// inlined here, where a call is nothing, compilers save in ticks.
  [[gnu::noinline]] bool look(const Vec3& q, double radius, Location& found) {
    const double way = length(q - at_), wanted = best_.signed_distance + radius;
    if (free_ - way >= wanted) return false;
    if (free_ > 0) {
      // Two balls that meet, without anything of the surface, are on one side of it. Without a tree a search takes the
      // same time however little is asked.
      const bool tree = (kFeatures & layout::feature_search) != 0 && view_->search != nullptr;
      const double within = tree ? std::fmax(wanted, way - free_) : HUGE_VAL;
      if (!locate_where<kFeatures>(*view_, q, detail::Anywhere{}, found, detail::kBoundSlack * within * within)) {
        at_ = q;
        free_ = within;
        return false;
      }
    } else {
      found = locate<kFeatures>(*view_, q, best_.at);
    }
    at_ = q;
    free_ = found.signed_distance;
    return true;
  }

  const View* view_;
  Location best_;
  Vec3 best_at_, at_;  ///< m, of the last point that was looked at, too
  double free_;        ///< m, that one's signed distance; outside the body, or less
};

}  // namespace palpate::runtime
