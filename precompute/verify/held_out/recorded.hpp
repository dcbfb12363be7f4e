// SPDX-License-Identifier: GPL-3.0-or-later
// Held-out contacts as JSON: part of verify's report, and what regression tests compare a file with.
#pragma once

#include "precompute/verify/held_out/statistics.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace palpate::verify {

/// [{tool, tool_patch, tool_weights, c, n, x, depth_m, thickness_m, filled, accepted, cause,
///   forces: [{kind, deflection_m, solved_N, baked_N, error, from_m of a path's first}],
///   limits: [{depth_m, solved, baked, error}], spin_rad, tool_x, tool_z, at_pair}]
/// with limits only where there are any, and what follows them only of tools with spins.
nlohmann::ordered_json to_json(const std::vector<HeldOut>& contacts);

/// {count, median, p95, worst: {error, contact, depth_m, c}, within: {"1%", "2%", "5%", "10%"}}
nlohmann::ordered_json to_json(const ErrorStatistics& statistics, const std::vector<HeldOut>& contacts);

/// Reads the "held_out" list of a report. Throws Error(io) or Error(bad_input) naming file and entry.
std::vector<HeldOut> read_recorded(const std::filesystem::path& file);

}  // namespace palpate::verify
