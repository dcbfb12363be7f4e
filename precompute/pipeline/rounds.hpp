// SPDX-License-Identifier: GPL-3.0-or-later
// Automatic sampling: rounds of normal indentations, each judged by hidden pushes between its sites.
//
// Every round is a function of the scene and of what the rounds before it solved, so that any number of threads or
// shards and any interruption give the same sites.
#pragma once

#include "precompute/pipeline/round_errors.hpp"
#include "precompute/pipeline/round_limits.hpp"

namespace palpate::pipeline {

/// Part of a plan's identity: raise it whenever the same outcomes give another next round.
inline constexpr int kRoundsRevision = 9;

/// Edge length (m) with which the first round begins: for `first_sites` on the area of the body, no smaller than half
/// of the smallest tool's radius.
double first_spacing(const Scene& scene, const Body& body);

/// The first round: a normal indentation at every site, all paths of the scene at sites spread evenly, hidden pushes
/// at places drawn evenly over the area that the tools can touch. Its inputs include what later rounds depend on.
/// Throws as make_plan.
bake::Plan first_round(const Sampled& sampled, const sites::HapticMesh& mesh);

/// Adds the next round: splits the edges with the largest errors. False, with nothing changed, where
/// sampling.most_sites are reached or every such edge is as short as edges become.
bool add_round(const Sampled& sampled, const JournalContent& journal, const RoundErrors& errors,
               sites::HapticMesh& mesh, bake::Plan& plan);

}  // namespace palpate::pipeline
