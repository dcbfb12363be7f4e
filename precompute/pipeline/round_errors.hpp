// SPDX-License-Identifier: GPL-3.0-or-later
// Errors between the sites of a round of automatic sampling: at its hidden pushes, and predicted for its edges.
#pragma once

#include <map>
#include <vector>

#include "formats/journal/journal.hpp"
#include "precompute/bake/plan.hpp"
#include "precompute/bake/sampling_estimate.hpp"
#include "precompute/common/body.hpp"
#include "precompute/sites/haptic_mesh.hpp"
#include "precompute/tool/tool.hpp"

namespace palpate::pipeline {

/// A scene and the bodies made from it.
struct Sampled {
  const Scene& scene;
  const Body& body;
  const std::vector<tool::Tool>& tools;
};

/// Forces between sites are interpolated linearly; errors are |interpolated - solved| over the largest of the solved
/// force, 2 % of the largest of its push, and response.floor.
struct RoundErrors {
  bake::SamplingEstimate estimate;  ///< without the number of rounds
  /// Predicted in the middle of edges, means over the depths: from the slopes at their ends, or in proportion to their
  /// length from what was measured in the middle of an edge that was split.
  std::map<sites::SiteEdge, double> edges;
};

/// `plan`: all its pairs have an outcome.
RoundErrors round_errors(const Sampled& sampled, const sites::HapticMesh& mesh, const bake::Plan& plan,
                         const JournalContent& journal);

}  // namespace palpate::pipeline
