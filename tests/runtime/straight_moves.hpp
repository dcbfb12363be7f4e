// SPDX-License-Identifier: GPL-3.0-or-later
// A ball tip moved in straight lines over a box.
#pragma once

#include <cmath>

#include "tests/runtime/support.hpp"

namespace palpate::test {

/// Moves a contact in a straight line and hands every tick to `see`.
template <class See>
void move(runtime::Contact& contact, const Vec3& from, const Vec3& to, double step, const See& see) {
  const int steps = static_cast<int>(std::ceil(length(to - from) / step));
  for (int i = 1; i <= steps; ++i) {
    const Pose pose = upright(from + (i / static_cast<double>(steps)) * (to - from));
    see(pose, contact.tick(pose));
  }
}
inline void move(runtime::Contact& contact, const Vec3& from, const Vec3& to) {
  move(contact, from, to, 2e-5, [](const Pose&, const Tick&) {});
}

/// Of the tip, so deep (m) in the top of the box.
inline Vec3 centre(double depth, double x = 0, double y = 0) { return {x, y, kTop + kTipRadius - depth}; }

/// A box that answers alike everywhere, a straight push without sideways force.
inline Options flat() {
  Options options = uniform();
  options.lateral = false;
  return options;
}

}  // namespace palpate::test
