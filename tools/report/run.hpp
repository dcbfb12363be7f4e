// SPDX-License-Identifier: GPL-3.0-or-later
// A run as the page plays it back: poses of the tool with the forces on it.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tools/cli/response_input.hpp"

namespace palpate::report {

/// Columns {time_s, position_m, quaternion (w, x, y, z), force_N, depth_m, state} of a motion (CSV) that is played, or
/// of a recording of `palpate drive`, which may still grow. At most `most` rows, evenly taken; the last one is kept.
/// `tool`: name; empty: the run's, or the file's first. Throws as read_motion and read_run do; Error(bad_input) for a
/// glove's run.
nlohmann::ordered_json played_run(const std::string& file, const cli::ResponseInput& response, const std::string& tool,
                                  std::size_t most = 1500);

}  // namespace palpate::report
