// SPDX-License-Identifier: MIT
// Plain triangle soups through OpenMesh's readers and writers, without its half-edge structure in between.
#pragma once

#include "formats/surface.hpp"

#include <filesystem>
#include <string>

namespace palpate {

/// What an OpenMesh reader delivered, exactly as indexed in the file.
struct PolygonSoup {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::int32_t> polygons;  ///< per triangle the polygon of the file it belongs to
  std::int32_t polygon_count = 0;      ///< of those with at least three different corners
};

/// Reads screened `content`; PLY must be text. `extension` is one of ".obj", ".off", ".stl", ".ply"; `binary`
/// matters to STL alone; `file` is for the message. Throws Error(bad_input) when OpenMesh refuses it.
PolygonSoup read_with_openmesh(const std::string& content, const std::filesystem::path& file,
                               const std::string& extension, bool binary);

/// The bytes of a surface file with this extension (see read_with_openmesh), STL in binary.
/// Throws Error(bad_input) when OpenMesh cannot write it.
std::string write_with_openmesh(const Surface& surface, const std::string& extension);

}  // namespace palpate
