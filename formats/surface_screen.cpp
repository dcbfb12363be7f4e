// SPDX-License-Identifier: MIT
// Screens of the line-based surface formats OBJ and OFF, and of STL in both its forms.
#include "formats/surface_screen.hpp"

#include "formats/surface_text.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace palpate {
namespace {

using detail::distinct;
using detail::TextScan;

Eigen::Vector3d three_coordinates(TextScan& scan, const std::string& what) {
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) point[axis] = scan.coordinate(scan.word(), what);
  return point;
}

// Takes one vertex from the current line and copies its three words, checked, to the plain text.
void add_vertex(SurfaceCensus& census, TextScan& scan, const std::string& what) {
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) {
    const auto token = scan.word();
    point[axis] = scan.coordinate(token, what);
    census.plain += ' ';
    census.plain += token;
  }
  census.bounds.extend(point);
  ++census.vertices;
}

std::int32_t group_index(SurfaceCensus& census, std::string name) {
  if (name.empty()) name = "default";
  const auto found = std::find(census.group_names.begin(), census.group_names.end(), name);
  if (found == census.group_names.end()) {
    census.group_names.push_back(std::move(name));
    return static_cast<std::int32_t>(census.group_names.size()) - 1;
  }
  return static_cast<std::int32_t>(found - census.group_names.begin());
}

std::size_t count_obj_vertices(std::string_view text, const std::filesystem::path& file) {
  TextScan scan(text, file);
  std::size_t count = 0;
  while (scan.next_line()) count += scan.word() == "v";
  return count;
}

// Binary STL has a fixed size for its facet count; a text STL that fits it by chance does not exist.
bool is_binary_stl(std::string_view bytes) {
  if (bytes.size() < 84) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  if (bytes.size() == 84 + 50 * std::uint64_t(count)) return true;
  return bytes.substr(0, 5) != "solid" || bytes.substr(0, 84).find('\0') != std::string_view::npos;
}

SurfaceCensus screen_binary_stl(std::string_view bytes, const std::filesystem::path& file) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  const std::uint64_t expected = 84 + 50 * std::uint64_t(count);
  if (bytes.size() < expected) {
    throw Error(ExitCode::bad_input, file.string() + ": truncated or not an STL file: its header announces " +
                                         std::to_string(count) + " facets, " + std::to_string(expected) +
                                         " bytes, but the file has " + std::to_string(bytes.size()));
  }
  SurfaceCensus census;
  census.binary = true;
  for (std::uint32_t facet = 0; facet < count; ++facet) {
    std::array<std::array<float, 3>, 3> corners{};
    std::memcpy(corners.data(), bytes.data() + 84 + 50 * std::size_t(facet) + 12, 36);
    for (const auto& corner : corners) {
      for (const float value : corner) {
        if (!std::isfinite(value) || std::abs(value) > largest_coordinate) {
          throw Error(ExitCode::bad_input, file.string() + ": facet " + std::to_string(facet) +
                                               ": a coordinate is not finite or beyond 1e15");
        }
      }
      census.bounds.extend(Eigen::Vector3d(corner[0], corner[1], corner[2]));
    }
    census.vertices += 3;
    census.polygons += corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
  }
  return census;
}

}  // namespace

SurfaceCensus screen_obj(std::string_view text, const std::filesystem::path& file) {
  const auto total = static_cast<std::int64_t>(count_obj_vertices(text, file));
  SurfaceCensus census;
  TextScan scan(text, file);
  std::string object, group;
  bool named = false;
  std::vector<std::int64_t> corners;
  while (scan.next_line()) {
    if (scan.rest().find('\0') != std::string_view::npos) scan.fail("a zero byte: not an OBJ file");
    const auto key = scan.word();
    if (key == "v" || key == "f") {
      scan.drop_comment();
      if (scan.rest().ends_with('\\')) scan.fail("lines continued by '\\' are not supported");
    }
    if (key == "v") {
      census.plain += 'v';
      add_vertex(census, scan, "vertex " + std::to_string(census.vertices + 1));
      census.plain += '\n';
    } else if (key == "o" || key == "g") {
      (key == "o" ? object : group) = scan.rest();
      if (key == "o") group.clear();
      named = true;
    } else if (key == "f") {
      corners.clear();
      for (auto token = scan.word(); !token.empty(); token = scan.word()) {
        const auto index = scan.integer(token.substr(0, token.find('/')), "face");
        const auto vertex = index < 0 ? static_cast<std::int64_t>(census.vertices) + index + 1 : index;
        if (vertex < 1 || vertex > total) {
          scan.fail("vertex index " + std::to_string(index) + " is outside 1.." + std::to_string(total));
        }
        corners.push_back(vertex);
        census.plain += (corners.size() == 1 ? "f " : " ") + std::to_string(vertex);
      }
      census.plain += '\n';
      if (corners.size() < 3) scan.fail("a face needs at least three corners");
      if (distinct(corners) < 3) continue;
      ++census.polygons;
      if (named) {
        census.groups.push_back(group_index(census, group.empty() ? object : group));
      } else {
        census.groups.push_back(group_index(census, file.stem().string()));
      }
    }
  }
  return census;
}

SurfaceCensus screen_off(std::string_view text, const std::filesystem::path& file) {
  TextScan scan(text, file);
  // A line with something on it, comments cut off; false at the end of the file.
  const auto filled_line = [&] {
    while (scan.next_line()) {
      scan.drop_comment();
      if (!scan.rest().empty()) return true;
    }
    return false;
  };
  const auto must = [&](const std::string& what) {
    if (!filled_line()) scan.fail("truncated: " + what + " is missing");
  };
  must("the OFF header");
  const auto header = scan.word();
  if (header != "OFF" && header != "COFF" && header != "NOFF" && header != "CNOFF") {
    scan.fail("not a supported OFF file: it begins with '" + std::string(header.substr(0, 16)) +
              "' (allowed: OFF, COFF, NOFF)");
  }
  if (scan.rest() == "BINARY") scan.fail("binary OFF is not supported: convert it to PLY");
  if (scan.rest().empty()) must("the line of counts");
  const auto vertices = scan.integer(scan.word(), "vertex count");
  const auto faces = scan.integer(scan.word(), "face count");
  if (vertices < 0 || faces < 0) scan.fail("negative counts");
  SurfaceCensus census;
  census.plain = "OFF\n" + std::to_string(vertices) + " " + std::to_string(faces) + " 0\n";
  for (std::int64_t vertex = 0; vertex < vertices; ++vertex) {
    must("vertex " + std::to_string(vertex) + " of " + std::to_string(vertices));
    add_vertex(census, scan, "vertex " + std::to_string(vertex));
    census.plain += '\n';
  }
  std::vector<std::int64_t> corners;
  for (std::int64_t face = 0; face < faces; ++face) {
    must("face " + std::to_string(face) + " of " + std::to_string(faces));
    const auto count = scan.integer(scan.word(), "face " + std::to_string(face));
    if (count < 3) scan.fail("face " + std::to_string(face) + " has " + std::to_string(count) + " corners, needs 3");
    corners.clear();
    census.plain += std::to_string(count);
    for (std::int64_t corner = 0; corner < count; ++corner) {
      const auto index = scan.integer(scan.word(), "face " + std::to_string(face));
      if (index < 0 || index >= vertices) {
        scan.fail("face " + std::to_string(face) + ": vertex index " + std::to_string(index) + " is outside 0.." +
                  std::to_string(vertices - 1));
      }
      corners.push_back(index);
      census.plain += ' ' + std::to_string(index);
    }
    census.plain += '\n';
    census.polygons += distinct(corners) >= 3;
  }
  return census;
}

SurfaceCensus screen_stl(std::string_view bytes, const std::filesystem::path& file) {
  static_assert(std::endian::native == std::endian::little, "binary STL is read in place");
  if (is_binary_stl(bytes)) return screen_binary_stl(bytes, file);
  SurfaceCensus census;
  TextScan scan(bytes, file);
  bool ended = false;
  while (scan.next_line()) {
    const auto key = scan.word();
    if (census.vertices == 0 && scan.line() == 1 && key != "solid") scan.fail("not an STL file: no 'solid' line");
    if (key == "endsolid") ended = true;
    if (key != "outer") continue;
    std::array<Eigen::Vector3f, 3> corners;
    for (auto& corner : corners) {
      if (!scan.next_line() || scan.word() != "vertex") scan.fail("expected 'vertex x y z': truncated or damaged");
      const auto point = three_coordinates(scan, "facet " + std::to_string(census.vertices / 3));
      census.bounds.extend(point);
      corner = point.cast<float>();
    }
    census.vertices += 3;
    census.polygons += corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
  }
  if (!ended) scan.fail("truncated: no 'endsolid' line");
  return census;
}

}  // namespace palpate
