// SPDX-License-Identifier: GPL-3.0-or-later
// What a response file says, for people: curves as a table, the body's surface with stiffness and friction on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "formats/surface_fields.hpp"
#include "palpate/runtime.hpp"

namespace palpate::cli {

struct CurveTable {
  std::string csv;
  std::size_t rows = 0;
  std::size_t responses = 0;  ///< that have rows
  std::size_t left_out = 0;   ///< responses of which no contact takes part: their site or tool vertex is in no patch
};

/// Every response alone, as the runtime evaluates it at its site, in the site's frame (x, y, outward normal), sticking
/// and from first touch: `points` (at least 2) deflections straight down to where it was sampled, even in the root of
/// the depth; and in a file with friction as many sideways ones along x and along y, even from -X to X, at the depth
/// `depth` (m) or, where that is deeper than was sampled, there. A column each: site and tool vertex (numbers, the
/// latter within the tool), tool, "solved" or "covered", "push", "sideways_x" or "sideways_y", deflection (m), force on
/// the tool (N), largest tangential force (N; empty in a frictionless file).
CurveTable response_curves(const runtime::View& view, double depth, int points);

struct BodyFieldOptions {
  std::uint32_t tool = 0;         ///< index into the file's tools
  std::uint32_t tool_vertex = 0;  ///< of that tool
  double depth = 0;               ///< m, of a straight push; above 0
};

/// The contact surface with what a straight push of a tool's vertex meets at every vertex of it: "stiffness" (N/m,
/// slope of the normal force), "force" (N, normal force), "friction" (N, largest tangential force; not in a
/// frictionless file), "covered" (share of the answer that was taken from neighbours). Throws Error(bad_input) where
/// the tool vertex is in no patch of the tool.
SurfaceFields body_fields(const runtime::View& view, const BodyFieldOptions& options);

}  // namespace palpate::cli
