// SPDX-License-Identifier: GPL-3.0-or-later
// Features that a file leaves out, the cost of those that it uses, and hints for a leaner scene.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "precompute/pipeline/pipeline.hpp"
#include "tools/cli/commands.hpp"
#include "tools/report/cost.hpp"

namespace palpate::report {

/// {features: [{name, present, without, bytes_per_response, bytes, solves, tick_ns, cause}]}. Bytes follow from the
/// file's layout, solves from the scene's paths. tick_ns: the press of this file less that of the same samples fitted
/// without the feature; absent where no such fit exists, with the cause.
nlohmann::ordered_json left_out(const CostInput& input, double tick_ns, const cli::Globals& globals);

/// Sentences: settings that are finer than perception, or coarser than they may be. `organ`, `cost`: those sections.
nlohmann::ordered_json hints(const CostInput& input, const nlohmann::ordered_json& organ,
                             const nlohmann::ordered_json& cost);

}  // namespace palpate::report
