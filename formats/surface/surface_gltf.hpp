// SPDX-License-Identifier: MIT
// Triangle meshes of a glTF 2.0 file (text or binary), by name, in world coordinates.
#pragma once

#include "formats/surface/surface.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// Reads `bytes` of a .gltf file, or of a .glb file when `binary`; external buffers are looked for beside
/// `file`. `wanted`: see SurfaceSource::meshes. Coordinates in file units.
/// Throws Error(bad_input): see read_surface.
Surface read_gltf(const std::string& bytes, const std::filesystem::path& file, const std::vector<std::string>& wanted,
                  bool binary);

}  // namespace palpate
