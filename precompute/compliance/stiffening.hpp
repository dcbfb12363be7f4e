// SPDX-License-Identifier: GPL-3.0-or-later
// By how much a dent grows less than its force under deep tools, from solves of two tools at once.
#pragma once

#include "precompute/compliance/bake_compliance.hpp"
#include "precompute/compliance/report.hpp"
#include "precompute/tool/tool.hpp"

#include <cstddef>
#include <vector>

namespace palpate::compliance {

/// A tool that is pressed at sites.
struct PressedTool {
  const tool::Tool& tool;
  const tool::ToolVertex& vertex;
  std::vector<double> depth;  ///< m, deepest push at each site; 0 where none is planned
};

/// Finds the stiffening b (layout::ComplianceHead) with which two tools at full depth lose to each other what they lose
/// in solves, along their normals and with the compliance between them that they have at a quarter of the depth: at
/// pairs of neighbouring sites that are spread over the body. `depth_scale`: m, of the response file. Deterministic; 0
/// where no pair of sites is near enough or no solve is usable, which the report says.
StiffeningReport measure_stiffening(const Body& body, const ComplianceSites& sites, const PressedTool& pressed,
                                    double depth_scale, const solve::PairOptions& solver);

}  // namespace palpate::compliance
