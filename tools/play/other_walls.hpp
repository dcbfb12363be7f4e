// SPDX-License-Identifier: GPL-3.0-or-later
// Walls that a tool touches beside the one that its contact follows, and contacts too near for their sum.
#pragma once

#include "palpate/contact/contact_set.hpp"
#include "palpate/contact/superposition.hpp"

namespace palpate::cli {

/// Counts for warnings of `play`. The view must outlive it.
class OtherWalls {
public:
  OtherWalls(const runtime::View& view, std::uint32_t tool) : radius_(view, tool) {}

  /// A single contact leaves out another wall that the tool overlaps.
  [[nodiscard]] static bool missed(const runtime::Contact& contact, const runtime::Pose& pose,
                                   const runtime::Tick& tick) {
    if (!tick.touches()) return false;
    runtime::WallSearchRequest<1> request;
    request.pose = pose;
    request.count = 1;
    request.feet[0] = contact.state().place.foot.point;
    request.gap = contact.size(tick.depth);
    return runtime::detail::find_wall(contact.view(), contact.shape(), request).clearance < 0;
  }
  template <int Most>
  [[nodiscard]] static bool missed(const runtime::ContactSet<Most>&, const runtime::Pose&, const runtime::Tick&) {
    return false;
  }

  /// The contacts of a set are so near each other that their sum is too large.
  [[nodiscard]] static bool near(const runtime::Contact&) { return false; }
  template <int Most>
  [[nodiscard]] bool near(const runtime::ContactSet<Most>& set) const {
    runtime::SuperpositionError error;
    for (std::size_t i = 0; i < set.each().size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        if (set.each()[i].touches() && set.each()[k].touches()) error.add(set.each()[k], radius_, set.each()[i], radius_);
      }
    }
    return error.notable();
  }

private:
  runtime::ContactRadius radius_;
};

}  // namespace palpate::cli
