// SPDX-License-Identifier: GPL-3.0-or-later
// An organ as the report shows it: numbers of every site, regions, tools, held-out contacts, and solved curves.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "palpate/format/response_view.hpp"
#include "precompute/pipeline/pipeline.hpp"
#include "precompute/verify/held_out/held_out.hpp"

namespace palpate::report {

/// Numbers of the response file alone: per site position (m), depth (m), support; per tool (its first vertex, pressed
/// straight in to half of the depth scale) stiffness (N/m), force (N), friction coefficient and source of the response.
nlohmann::ordered_json organ_of_file(const runtime::View& view);

/// Adds numbers of the scene and its bake: thickness (m) and errors (shares) of every site, regions, refusals.
void add_bake(nlohmann::ordered_json& organ, const runtime::View& view, const pipeline::Pipeline& pipeline,
              const JournalContent& journal, const fit::FitReport& fit);

/// Solved samples of every pair that the page draws beside the baked curves: normal indentations [depth, force], and of
/// each tangential depth the pushes along one direction [deflection, force against it] (m, N).
nlohmann::ordered_json solved_curves(const pipeline::Pipeline& pipeline, const JournalContent& journal);

/// Held-out contacts with their largest errors and their normal indentations.
nlohmann::ordered_json held_out_places(const std::vector<verify::HeldOut>& contacts);

}  // namespace palpate::report
