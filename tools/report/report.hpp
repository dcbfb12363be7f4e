// SPDX-License-Identifier: GPL-3.0-or-later
// All numbers of a report, from a baked scene and reports of other commands.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "precompute/pipeline/pipeline.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/response_input.hpp"

namespace palpate::report {

struct ReportInput {
  std::string scene;
  std::string verify;               ///< report of `palpate verify SCENE`; empty: errors between sites are not known
  std::string battery;              ///< report of `palpate verify --battery stiff`; empty: none
  std::vector<std::string> beside;  ///< scenes of the same organ that were baked otherwise
  std::string compared;             ///< response file that is shown beside this one; empty: none
  std::string run;                  ///< motion (CSV) or recording of a run that is played back; empty: none
  std::string tool;                 ///< of the run; empty: the first
  int contacts = 20;                ///< that are timed
  bool laws = true;                 ///< other response laws and features left out are fitted and timed
};

/// {title, command, organ, curves, held_out, error_time, stability, left_out, hints, provenance, compared, run}: every
/// section names the command of its figures. `pipeline`: prepared and planned.
nlohmann::ordered_json make_report(const ReportInput& input, const pipeline::Pipeline& pipeline,
                                   const cli::ResponseInput& response, const cli::Globals& globals);

}  // namespace palpate::report
