// SPDX-License-Identifier: GPL-3.0-or-later
// Error against run time: response laws on the samples of one bake, whole files against held-out solves.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "precompute/pipeline/pipeline.hpp"
#include "precompute/verify/held_out/held_out.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/response_input.hpp"

namespace palpate::report {

/// Relative difference of two forces that is just noticeable (Tan, Srinivasan, Eberman and Cheng 1994).
inline constexpr double kNoticeable = 0.07;

struct CostInput {
  const pipeline::Pipeline& pipeline;
  const JournalContent& journal;
  const cli::ResponseInput& response;
  const std::vector<verify::HeldOut>& held_out;  ///< empty: files have no errors, and only this file is listed
  std::vector<std::string> beside;       ///< scenes of the same organ that were baked otherwise
  int contacts = 20;                     ///< timed, of each file
  bool laws = true;                      ///< other response laws are fitted, too
};

/// {noticeable, laws: [{model, bytes_per_response, tick_ns, force_ns, error, error_paths}], solve: {ns, error},
///  files: [{label, chosen, tolerance, spacing_m, coefficient_bits, degrees, coefficients, bytes,
///           bytes_per_response, tick_ns, bake_hours,
///           error, error_tangential}]}
nlohmann::ordered_json error_against_time(const CostInput& input, const cli::Globals& globals);

}  // namespace palpate::report
