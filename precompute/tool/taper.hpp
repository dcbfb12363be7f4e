// SPDX-License-Identifier: GPL-3.0-or-later
// Pointed tools of revolution: cone and needle.
#pragma once

#include "precompute/tool/tool.hpp"

namespace palpate::tool {

/// All points within `tip` of a convex core: a cone with its apex in the origin that opens along +z by `half_angle`
/// (rad) up to the radius `shaft` - `tip`, then a cylinder, to z = length (m). Both ends of the axis are rounded.
std::shared_ptr<const ToolShape> make_taper(double tip, double half_angle, double shaft, double length);

}  // namespace palpate::tool
