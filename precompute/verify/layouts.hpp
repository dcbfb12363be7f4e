// SPDX-License-Identifier: GPL-3.0-or-later
// Places of several tools on a body, for solves of all of them at once.
#pragma once

#include "formats/journal/samples.hpp"
#include "precompute/common/body.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpate::verify {

enum class Layout {
  line,    ///< along one direction, `spacing` apart
  ring,    ///< round the middle between them, neighbours `spacing` apart; the first lies at the given frame
  pinch,   ///< two: the second on the wall behind the first, pressing the other way
  random,  ///< in random directions, at random distances of `spacing` to `farthest` from the first
};

/// The layout of a name; none for another name.
std::optional<Layout> layout_of(const std::string& name);

struct LayoutOptions {
  Layout layout = Layout::line;
  int count = 2;               ///< tools, [1, 5]; of pinch 2
  double spacing = 0.0;        ///< m, > 0
  double farthest = 0.0;       ///< m, of random, at least `spacing`
  double angle = 0.0;          ///< rad, of the direction from the frame's x to its y; not of random
  double aside = 0.0;          ///< m, by which a place may lie off the frame's normal
  double normal_radius = 0.0;  ///< m, over which the normals of places are averaged; not of pinch
  std::uint32_t seed = 1;      ///< of random
};

struct Places {
  /// The given one first. A pinch's second one has its axes with n and y reversed. In the other layouts each has the
  /// surface's normal, and the first one's axes turned to it on the shortest way.
  std::vector<ContactFrame> frames;
  std::string cause;  ///< why there are none: it begins with "place"
};

/// Puts tools beside the one at `frame` on the body's surface. A place is refused where the surface bends away, ends or
/// is held.
Places lay_out(const Body& body, const ContactFrame& frame, const LayoutOptions& options);

}  // namespace palpate::verify
