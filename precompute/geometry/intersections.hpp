// SPDX-License-Identifier: GPL-3.0-or-later
// Whether triangle surfaces cross themselves or each other.
#pragma once

#include "formats/surface.hpp"

#include <vector>

namespace palpate {

/// True when two triangles meet elsewhere than in a shared edge or vertex, or a triangle has no area. The
/// surface must be a manifold; throws Error(bad_input) where it is not.
bool self_intersects(const Surface& surface);

/// The triangles that self_intersects complains of, ascending, each once.
std::vector<std::int32_t> crossing_triangles(const Surface& surface);

/// True when a triangle of one meets a triangle of the other. One surface inside the other does not count.
bool surfaces_intersect(const Surface& first, const Surface& second);

}  // namespace palpate
