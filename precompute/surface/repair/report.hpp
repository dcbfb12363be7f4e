// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of a prepared surface: moves, volume, area, thickness, and whether it is a thin bag.
#pragma once

#include "precompute/common/body.hpp"

#include <string>
#include <vector>

namespace palpate::surface {

/// A point of a surface with the outward normal of its triangle.
struct SurfacePoint {
  Eigen::Vector3d point{0, 0, 0};   ///< m
  Eigen::Vector3d normal{0, 0, 1};  ///< unit
  std::int32_t triangle = -1;
};

/// `count` points spread evenly by area, always the same ones.
std::vector<SurfacePoint> spread_points(const Surface& surface, std::size_t count);

/// Fills sizes, volume, area, thickness, facet_depth and thin_bag for a closed outward surface.
///
/// thin_bag: median thickness below a twentieth of the diagonal, the surface a sheet rather than a rod
/// (thickness x area / volume below 3: 2 for a plate, 4 for a rod, 6 for a ball) that is bent round
/// something (volume below 0.35 of the convex hull's). A shell with a cavity of its own is what it should be.
void measure(const geometry::SurfaceQuery& query, SurfaceReport& report);

/// Distances from the vertices and triangle centres of `from` to `to`: {largest, mean} in m.
std::pair<double, double> distances(const Surface& from, const geometry::SurfaceQuery& to);

/// Several lines for the user, each ended by a newline.
std::string text(const SurfaceReport& report);
/// Text of the body, then of every region whose surface had faults.
std::string text(const Body& body);

}  // namespace palpate::surface
