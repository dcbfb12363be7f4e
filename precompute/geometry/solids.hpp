// SPDX-License-Identifier: GPL-3.0-or-later
// Closed manifold surfaces of spheres, ellipsoids and boxes: outward triangles, one named part.
#pragma once

#include "formats/surface.hpp"

#include <string>

namespace palpate {

/// Unit sphere: each edge of an icosahedron cut into `frequency` (>= 1) parts; 20 frequency^2 triangles.
Surface geodesic_sphere(int frequency, const std::string& name);

/// Frequency at which a surface of about `area` (m^2) gets edges of about `edge` (m).
int geodesic_frequency(double area, double edge);

/// Ellipsoid with semi-axes along x, y, z (m).
Surface ellipsoid(const Eigen::Vector3d& centre, const Eigen::Vector3d& semi_axes, double edge,
                  const std::string& name);

/// Axis-aligned box from `low` to `high` (m); edges about `edge` (m).
Surface box_solid(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double edge, const std::string& name);

}  // namespace palpate
