// SPDX-License-Identifier: GPL-3.0-or-later
// Automatic sampling: rounds of normal indentations, each judged by hidden pushes between its sites.
//
// Every round is a function of the scene and of what the rounds before it solved, so that any number of threads or
// shards and any interruption give the same sites.
#pragma once

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

/// Part of a plan's identity: raise it whenever the same outcomes give another next round.
inline constexpr int kRoundsRevision = 7;

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
  double aim = 0.7;            ///< of the tolerance: the 95th percentile that ends the rounds, because that of other
                               ///< contacts differs
  double law = 0.5;            ///< of the tolerance: what responses may miss of the samples that they are fitted to
  int rounds = 12;             ///< at most
};

/// Edge length (m) with which the first round begins: for `first_sites` on the area of the body, no smaller than half
/// of the smallest tool's radius.
double first_spacing(const Scene& scene, const Body& body);

/// The first round: a normal indentation at every site, all paths of the scene at sites spread evenly, hidden pushes
/// at places drawn evenly over the area that the tools can touch. Its inputs include what later rounds depend on.
/// Throws as make_plan.
bake::Plan first_round(const Sampled& sampled, const sites::HapticMesh& mesh);

/// Compares the hidden pushes of a plan whose pairs all have an outcome with what the sites predict.
bake::SamplingEstimate judge(const Sampled& sampled, const sites::HapticMesh& mesh, const bake::Plan& plan,
                             const JournalContent& journal);

/// Adds the next round: splits edges over which the second difference of the force is largest, and those of patches in
/// which a hidden push was missed. False, with nothing changed, where sampling.most_sites are reached or every such
/// edge is as short as edges become.
bool add_round(const Sampled& sampled, const JournalContent& journal, sites::HapticMesh& mesh, bake::Plan& plan);

}  // namespace palpate::pipeline
