// SPDX-License-Identifier: MIT
// Readers of plain surface files into polygons, in double precision and as indexed in the file.
#pragma once

#include "formats/scene/frame.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Contents of a file. Polygon p has the corners [first[p], first[p + 1]).
struct PolygonSoup {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::int32_t> corners;  ///< indices of vertices, in range
  std::vector<std::size_t> first{0};
  std::vector<std::int32_t> groups;      ///< per polygon an index into group_names; empty: there are none
  std::vector<std::string> group_names;  ///< first seen first
  Frame frame = Frame::unstated;         ///< as a comment of 3D Slicer's states it
  bool single = false;                   ///< coordinates are 32-bit floats
  int decimals = -1;                     ///< most digits behind the point of a text; -1: binary, or with exponents
  std::vector<std::string> notes;        ///< what was odd and is read all the same

  [[nodiscard]] std::size_t polygons() const { return first.size() - 1; }
  void end_polygon() { first.push_back(corners.size()); }
};

/// Largest magnitude of a coordinate that is accepted: beyond it squares overflow single precision.
inline constexpr double largest_coordinate = 1e15;

/// Each throws Error(bad_input) "file:line: cause", or names the element where the file has no lines. Polygons of less
/// than three different corners are left out.
PolygonSoup read_obj(std::string_view text, const std::filesystem::path& file);
PolygonSoup read_off(std::string_view text, const std::filesystem::path& file);
PolygonSoup read_stl(std::string_view bytes, const std::filesystem::path& file);
PolygonSoup read_ply(std::string_view bytes, const std::filesystem::path& file);
PolygonSoup read_vtk(std::string_view bytes, const std::filesystem::path& file);  ///< legacy .vtk: POLYDATA
PolygonSoup read_vtp(std::string_view bytes, const std::filesystem::path& file);  ///< XML .vtp: PolyData

/// Triangles of a polygon: a fan where it is convex, else ears cut off in its mean plane, so that a concave one is
/// covered once. At least three corners.
std::vector<std::array<std::int32_t, 3>> triangles_of(const std::vector<Eigen::Vector3d>& vertices,
                                                      const std::int32_t* corners, std::size_t count);

/// The frame that a comment with "SPACE=LPS" or "SPACE=RAS" states.
Frame stated_frame(std::string_view comment);

}  // namespace palpate
