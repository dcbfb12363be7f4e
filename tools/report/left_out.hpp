// SPDX-License-Identifier: GPL-3.0-or-later
// Features that a file leaves out, the cost of those that it uses, and hints for a leaner scene.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "formats/response/response.hpp"
#include "tools/cli/commands.hpp"
#include "tools/report/cost.hpp"

namespace palpate::report {

/// {features: [{name, present, without, bytes_per_response, bytes, solves, tick_ns, slide_ns, cause}]}. Bytes follow
/// from the file's layout, solves from the paths of the plan; null where another bake alone would show them. tick_ns,
/// slide_ns: a press and a slide of two files of the same responses, one with the feature and one without
/// (cli::with_feature, cli::without_feature); absent where no such two files exist, with the cause. `content`: of the
/// response file.
nlohmann::ordered_json left_out(const CostInput& input, const ResponseFileContent& content,
                                const cli::Globals& globals);

/// Sentences: settings that are finer than perception, or coarser than they may be. `organ`, `cost`: those sections.
nlohmann::ordered_json hints(const CostInput& input, const nlohmann::ordered_json& organ,
                             const nlohmann::ordered_json& cost);

}  // namespace palpate::report
