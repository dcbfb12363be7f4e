// SPDX-License-Identifier: GPL-3.0-or-later
// Which pairs of a plan are recorded or follow a closed form, and their samples.
#pragma once

#include <vector>

#include "formats/scene/scene.hpp"
#include "formats/scene/scene_sources.hpp"
#include "precompute/bake/plan.hpp"
#include "precompute/common/body.hpp"
#include "precompute/fit/external_samples.hpp"
#include "precompute/sites/haptic_mesh.hpp"
#include "precompute/tool/tool.hpp"

namespace palpate::pipeline {

/// Reads the scene's recordings and applies its laws. Throws Error(bad_input) that names the recording's line, or the
/// scene and the law, and what is wrong; Error(io) where a recording cannot be read.
fit::PairSources find_sources(const Scene& scene, const SceneSources& wanted, const Body& body,
                              const std::vector<tool::Tool>& tools, const sites::HapticMesh& mesh,
                              const bake::Plan& plan);

}  // namespace palpate::pipeline
