// SPDX-License-Identifier: GPL-3.0-or-later
// A response file in readable form: curves as a table, the body's surface with stiffness and friction on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "formats/fields/surface_fields.hpp"
#include "palpate/format/response_view.hpp"

namespace palpate::cli {

struct CurveTable {
  std::string csv;
  std::size_t rows = 0;
  std::size_t responses = 0;
};

/// Every response alone, in the frame of its site (x, y, outward normal), while the contact sticks: `points` (at least 2)
/// normal deflections to the depth where it was sampled, even in the root of the depth; and in a file with friction as
/// many tangential ones along x and along y, even from -X to X, at the depth `depth` (m) or at the sampled depth where
/// that is less. A column each: site and tool vertex (numbers, the latter within the tool), tool, source ("solved",
/// "filled", "measured" or "analytic"), "normal", "tangential_x" or "tangential_y", deflection (m), force on the tool
/// (N), mu F (N; empty in a frictionless file).
CurveTable response_curves(const runtime::View& view, double depth, int points);

struct BodyFieldOptions {
  std::uint32_t tool = 0;         ///< index into the file's tools
  std::uint32_t tool_vertex = 0;  ///< of that tool
  double depth = 0;               ///< m, of a normal indentation; above 0
};

/// The contact surface with fields of a normal indentation by a tool's vertex, at every vertex of the surface:
/// "stiffness" (N/m, slope of the normal force), "force" (N, normal force), "friction" (N, mu F; not in a frictionless
/// file), "filled" (share of the response that was filled from neighbours). Throws Error(bad_input) where the tool
/// vertex is in no patch of the tool.
SurfaceFields body_fields(const runtime::View& view, const BodyFieldOptions& options);

}  // namespace palpate::cli
