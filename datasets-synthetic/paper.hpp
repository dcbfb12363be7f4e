// SPDX-License-Identifier: GPL-3.0-or-later
// The samples of figures 2 and 4 of Mahvash and Hayward (2004) as scenes.
#pragma once

#include <filesystem>

namespace palpate::synth {

/// Scene files. The middle of each sample's top is the origin, its normal +z: there the tools touch first.
struct PaperScenes {
  std::filesystem::path loose, firm;             ///< figure 2: one rubber strip, three tools, two supports
  std::filesystem::path homogeneous, inclusion;  ///< figure 4: a sample alike all over, and with a hard lump at +x
};

/// Writes the scenes and their surfaces into `folder` (created when missing). The paper gives no measures: these are
/// chosen so that what it reports is seen. Throws Error(io).
PaperScenes write_paper_scenes(const std::filesystem::path& folder);

}  // namespace palpate::synth
