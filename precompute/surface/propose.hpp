// SPDX-License-Identifier: GPL-3.0-or-later
// A first scene for a file that nobody wrote a scene for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::surface {

/// A mesh, a label or a file, and what the proposal makes of it.
struct Found {
  std::string name;
  std::string role;        ///< "body", "region", "cavity" or "left out"
  std::string reason;      ///< why it is left out
  double volume = 0.0;     ///< m^3; of an open mesh 0
  double extents[3] = {};  ///< m
};

struct Proposal {
  std::string scene;  ///< TOML; reads and prepares as it is
  std::vector<Found> found;
};

/// Proposes a scene for a surface file, a label image, or a folder of them with one organ a file (TotalSegmentator's).
/// The largest closed mesh or label is the body; those strictly inside it become regions, or cavities where their name
/// says vessel, duct, lumen or cyst. Tissues come from names. The unit of a surface file is guessed from its size.
/// File names are written relative to `folder`, where the scene is to lie; empty: as they are given.
/// Throws Error as the readers do, and Error(bad_input) where nothing is there that could be a body.
Proposal propose_scene(const std::filesystem::path& from, const std::filesystem::path& folder);

}  // namespace palpate::surface
