// SPDX-License-Identifier: GPL-3.0-or-later
// A tool from a closed triangle mesh: where it may touch, and how sharp it is there.
#pragma once

#include "precompute/tool/tool.hpp"

namespace palpate::tool {

/// Sets shape, vertices, patches and edges of a tool whose scene is set. Throws Error as make_tool.
void add_mesh(Tool& tool);

/// A contact vertex of a mesh tool on its smoothed surface, nearest to `near` (tool frame), with the sharpness that the
/// tool has there. Its tangent leans towards the handle; it has no name.
ToolVertex mesh_vertex(const Tool& tool, const Eigen::Vector3d& near);

}  // namespace palpate::tool
