// SPDX-License-Identifier: GPL-3.0-or-later
// Whether triangle surfaces cross themselves or each other. Exact.
#pragma once

#include "formats/surface/surface.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate::geometry {

/// Pairs of triangles that meet anywhere but in the corners or the edge they share by index, (lower, higher),
/// sorted. Triangles without area take no part. Any soup will do.
std::vector<std::array<std::int32_t, 2>> crossings(const Surface& surface);

/// Number of pairs of a triangle of `a` and one of `b` that meet.
std::size_t crossings(const Surface& a, const Surface& b);

/// The triangles of crossings(surface) and those without area, ascending, each once.
std::vector<std::int32_t> crossing_triangles(const Surface& surface);

/// True when crossing_triangles would name any. The surface must be a manifold; throws Error(bad_input) where it
/// is not.
bool self_intersects(const Surface& surface);

/// True when a triangle of one meets a triangle of the other. One surface inside the other does not count.
bool surfaces_intersect(const Surface& first, const Surface& second);

}  // namespace palpate::geometry
