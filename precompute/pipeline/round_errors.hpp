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

/// Numbers of automatic sampling.
struct RoundLimits {
  double first_sites = 60;     ///< in the first round, on a body without margins or thin walls
  double least_edge = 0.2;     ///< of the smallest tool's radius: shorter edges are not split
  double full_share = 0.1;     ///< of the sites, that are solved in full
  std::size_t least_full = 8;  ///< sites solved in full
  std::size_t hidden = 40;     ///< hidden places of the first round
  std::size_t more = 8;        ///< of every later one
  double growth = 0.6;         ///< most edges split in a round, over the number of sites, far from the aim
  double least_growth = 0.1;   ///< the same, near it
  double aim = 0.8;            ///< of the tolerance: the 95th percentile between sites that ends the rounds
  double law = 0.5;            ///< of the tolerance: what responses may miss of the samples that they are fitted to;
                               ///< both together are 0.94 of it
  int rounds = 12;             ///< at most
};

/// The samples of a pair that was accepted; null for any other.
const JournalPair* accepted(const JournalContent& journal, std::uint32_t pair);

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
