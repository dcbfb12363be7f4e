// SPDX-License-Identifier: MIT
// Checks plain surface files before OpenMesh reads them: its readers skip damaged lines in silence.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// What a well-formed file holds; what OpenMesh delivers must agree with it.
struct SurfaceCensus {
  std::size_t vertices = 0;              ///< coordinates in the file (STL: three per facet)
  std::size_t polygons = 0;              ///< polygons with at least three different corners
  Eigen::AlignedBox3d bounds;            ///< of the coordinates, in file units
  bool binary = false;                   ///< STL only: which of its two forms
  std::string plain;                     ///< the geometry alone in a form OpenMesh understands; STL: empty, as it is
  std::vector<std::int32_t> groups;      ///< OBJ only: per polygon an index into group_names
  std::vector<std::string> group_names;  ///< OBJ only: group and object names, first seen first
};

/// Largest magnitude of a coordinate that is accepted: beyond it squares overflow single precision.
inline constexpr double largest_coordinate = 1e15;

/// Each throws Error(bad_input) "file:line: cause", or names the element where the file has no lines.
SurfaceCensus screen_obj(std::string_view text, const std::filesystem::path& file);
SurfaceCensus screen_off(std::string_view text, const std::filesystem::path& file);
SurfaceCensus screen_stl(std::string_view bytes, const std::filesystem::path& file);
SurfaceCensus screen_ply(std::string_view bytes, const std::filesystem::path& file);

}  // namespace palpate
