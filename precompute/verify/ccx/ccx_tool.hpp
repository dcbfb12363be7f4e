// SPDX-License-Identifier: GPL-3.0-or-later
// A rigid tool for CalculiX: its surface as quadratic triangles.
#pragma once

#include "precompute/tool/tool.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace palpate::verify {

/// The part of a tool's surface that may touch (tool frame).
struct ToolFacets {
  std::vector<Eigen::Vector3d> nodes;              ///< m
  std::vector<std::array<std::int32_t, 6>> faces;  ///< corners counter-clockwise from outside, middles 01, 12, 20
  std::int32_t corner_count = 0;                   ///< nodes [0, corner_count) are corners
  Eigen::Vector3d inside{0, 0, 0};                 ///< m; sees the back of every face
};

/// Rings of facets with edges of about `size` (m) about the tip of a sphere or a punch, and of size / 3 round a punch's
/// rim; every node lies on the tool. They reach to 75 degrees up the sphere, to a radius up the wall of the punch.
/// Throws std::invalid_argument for another shape.
ToolFacets tool_facets(const tool::Tool& tool, double size);

}  // namespace palpate::verify
