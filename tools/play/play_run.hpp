// SPDX-License-Identifier: GPL-3.0-or-later
// A recorded run of a device once more: what the contact did in the scene, and whether the same forces come out.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "device/recording/replay.hpp"
#include "tools/cli/response_input.hpp"
#include "tools/play/play.hpp"

namespace palpate::cli {

/// Whether the file begins as a recording does; what cannot be read does not.
bool is_run(const std::string& path);

/// Reads a recording. Throws Error(io) when it cannot be read, Error(bad_input) when it is damaged.
device::RunLog read_run(const std::string& path);

struct PlayedRun {
  std::vector<PlayedRow> rows;  ///< one a tick, of a glove one a finger; time since the first; no contact without force
  PlaySummary summary;
  device::Replay replay;
  bool same_response = false;  ///< the response file is the one that the run was made with, byte for byte
};

/// Against that response file with the tool of that index.
PlayedRun play_run(const device::RunLog& log, const ResponseInput& input, std::uint32_t tool);

/// Force on the hand, position, depth and sample age over time, in the device's frame; of a glove pulls and bends. At
/// least one record.
std::string run_svg(const device::RunLog& log, const std::string& title);

/// XXH64 of the whole file, as recordings have it.
std::uint64_t response_hash(const ResponseInput& input);

}  // namespace palpate::cli
