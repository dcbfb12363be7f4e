// SPDX-License-Identifier: GPL-3.0-or-later
// Signed distance functions of the rigid tools, each in its own frame (see Tool in tool.hpp).
#pragma once

#include "precompute/tool/tool.hpp"

namespace palpate::tool {

/// Ball of radius `radius` round the origin.
std::shared_ptr<const ToolShape> make_sphere(double radius);

/// All points within `radius` of the segment from the origin to (0, 0, length).
std::shared_ptr<const ToolShape> make_capsule(double radius, double length);

/// Upright cylinder with its lower face in the plane z = 0 and both rims rounded by `edge_radius`.
std::shared_ptr<const ToolShape> make_punch(double radius, double edge_radius, double height);

}  // namespace palpate::tool
