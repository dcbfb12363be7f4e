// SPDX-License-Identifier: GPL-3.0-or-later
// Closed manifold surfaces of known shape: outward triangles, one named part.
#pragma once

#include "precompute/geometry/solids.hpp"

#include <string>
#include <vector>

namespace palpate::synth {

/// Box from -size/2 to size/2 in x and y and from -size.z to 0 in z (its top lies in z = 0); edges about `edge` (m).
Surface box(const Eigen::Vector3d& size, double edge, const std::string& name);

/// Sphere tip as a tool mesh: centre at the origin.
Surface sphere_tool(double radius);
/// Capsule as a tool mesh: the tip cap's centre at the origin, the other at (0, 0, length).
Surface capsule_tool(double radius, double length);
/// Pointed instrument: tip sphere about the origin, a cone that widens to a shaft, a flat end at z = length.
Surface stylus_tool(double tip_radius, double shaft_radius, double length);

}  // namespace palpate::synth
