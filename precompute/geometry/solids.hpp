// SPDX-License-Identifier: GPL-3.0-or-later
// Closed manifold surfaces of spheres, ellipsoids, boxes and turned profiles: outward triangles, one named part.
#pragma once

#include "formats/surface/surface.hpp"

#include <string>
#include <vector>

namespace palpate::geometry {

/// Unit sphere: each edge of an icosahedron cut into `frequency` (>= 1) parts; 20 frequency^2 triangles.
Surface geodesic_sphere(int frequency, const std::string& name);

/// Frequency at which a surface of about `area` (m^2) gets edges of about `edge` (m).
int geodesic_frequency(double area, double edge);

/// Ellipsoid with semi-axes along x, y, z (m).
Surface ellipsoid(const Eigen::Vector3d& centre, const Eigen::Vector3d& semi_axes, double edge,
                  const std::string& name);

/// Axis-aligned box from `low` to `high` (m); edges about `edge` (m).
Surface box_solid(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double edge, const std::string& name);

/// A point of a profile that is turned about the z axis.
struct ProfilePoint {
  double radius = 0.0;  ///< m; 0 at the first and the last point only
  double z = 0.0;       ///< m
};

/// Surface of revolution. The profile runs from the pole below to the pole above, counter-clockwise about the solid.
Surface revolved(const std::vector<ProfilePoint>& profile, int segments, const std::string& name);

}  // namespace palpate::geometry
