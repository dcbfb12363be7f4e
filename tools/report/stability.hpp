// SPDX-License-Identifier: GPL-3.0-or-later
// Numerical stability: of this bake's solves, of the stiff battery's cells, and of devices that hold the file.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "palpate/format/response_view.hpp"
#include "precompute/pipeline/pipeline.hpp"

namespace palpate::report {

/// {planned, accepted, refused, causes: [{cause, pairs}], shortened, smallest_jacobian, largest_penetration_of_depth,
///  iterations: {median, p95, worst}, error_estimate: {...}, finer_mesh}
nlohmann::ordered_json bake_stability(const pipeline::Pipeline& pipeline, const JournalContent& journal);

/// The cells of a report of `verify --battery stiff`, each with its modulus, ratio and depth, and whether the scene's
/// own are near: modulus within a factor of 10, Poisson's ratio within 0.05, depth over radius within a factor of 2.
/// Throws Error(bad_input) where `battery` is no such report. `source` names it.
nlohmann::ordered_json battery_stability(const nlohmann::ordered_json& battery, const std::string& source,
                                         const Scene& scene);

/// Per simulated device the stiffness that is safe in any hand, that at which a usual grip begins to oscillate, and the
/// file's (N/m). Empty where the program was built without devices.
nlohmann::ordered_json device_stability(const runtime::View& view);

}  // namespace palpate::report
