// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of the pipeline as commands run and report them.
#pragma once

#include "precompute/pipeline/pipeline.hpp"
#include "tools/cli/commands.hpp"

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace palpate::cli {

/// Bakes with progress on standard error until done or interrupted. Throws Interrupted when stopped early.
/// With automatic sampling round after round, until there are no more.
bake::BakeReport bake_with_progress(pipeline::Pipeline& pipeline, const Globals& globals);

/// "round 3: 56 hidden pushes are missed by 1.10 % at the median, ...", in one line without its end.
std::string sampling_text(const bake::SamplingEstimate& estimate, double tolerance);

nlohmann::ordered_json bake_json(const pipeline::Pipeline& pipeline, const bake::BakeReport& report);
std::string bake_text(const pipeline::Pipeline& pipeline, const bake::BakeReport& report);
nlohmann::ordered_json fit_json(const pipeline::Pipeline& pipeline, const fit::FitReport& report);
/// Throws Error(tolerance) where more pairs were refused than the scene allows, or automatic sampling ended with an
/// error that is expected to be beyond the scene's tolerance. The response file is written.
void check_tolerance(const pipeline::Pipeline& pipeline, const fit::FitReport& report);
std::string fit_text(const pipeline::Pipeline& pipeline, const fit::FitReport& report);

}  // namespace palpate::cli
