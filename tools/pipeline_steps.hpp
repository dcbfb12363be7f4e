// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of the pipeline as commands run and report them.
#pragma once

#include "precompute/bake/pipeline.hpp"
#include "tools/commands.hpp"

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace palpate::cli {

/// Bakes with progress on standard error until done or interrupted. Throws Interrupted when stopped early.
BakeReport bake_with_progress(const pipeline::Pipeline& pipeline, const Globals& globals);

nlohmann::ordered_json bake_json(const pipeline::Pipeline& pipeline, const BakeReport& report);
std::string bake_text(const pipeline::Pipeline& pipeline, const BakeReport& report);
nlohmann::ordered_json fit_json(const pipeline::Pipeline& pipeline, const FitReport& report);
std::string fit_text(const pipeline::Pipeline& pipeline, const FitReport& report);

}  // namespace palpate::cli
