// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings of a real tool, made samples of the planned pairs that they belong to.
#pragma once

#include <vector>

#include "formats/scene/scene.hpp"
#include "formats/scene/scene_sources.hpp"
#include "precompute/bake/plan.hpp"
#include "precompute/common/body.hpp"
#include "precompute/fit/external_samples.hpp"
#include "precompute/tool/tool.hpp"

namespace palpate::pipeline {

/// Reads the recordings and adds their rows, by pair, and the hashes of their files to `sources`. A contact belongs to
/// the nearest site whose surface faces as its own does. Throws as find_sources.
void read_recordings(const Scene& scene, const std::vector<MeasuredScene>& measured, const Body& body,
                     const std::vector<tool::Tool>& tools, const bake::Plan& plan, fit::PairSources& sources);

}  // namespace palpate::pipeline
