// SPDX-License-Identifier: GPL-3.0-or-later
// What a tool that is felt at one place misses, and what one that is felt at several has too much of.
#pragma once

#include "palpate/contact/contact_set.hpp"

namespace palpate::cli {

/// Of a tool and its last tick. The view must outlive it.
class Elsewhere {
public:
  Elsewhere(const runtime::View& view, std::uint32_t tool) : finder_(view, tool) {}

  /// Felt at one place, the tool touches at another, too.
  bool missed(const runtime::Contact&, const runtime::Pose& pose, const runtime::Tick& tick) {
    if (!tick.touches()) return false;
    place_.pose = pose;
    place_.count = 1;
    place_.at[0] = tick.body_point;
    return finder_.look(place_, 0).touch.clearance < 0;
  }
  static bool missed(const runtime::ContactSet<3>&, const runtime::Pose&, const runtime::Tick&) { return false; }

  /// Felt at several, these lie so near each other that their sum is too large.
  static bool near(const runtime::Contact&) { return false; }
  static bool near(const runtime::ContactSet<3>& places) { return places.last().overlap.near(); }

private:
  runtime::PlaceFinder<> finder_;
  runtime::Places<1> place_;
};

}  // namespace palpate::cli
