// SPDX-License-Identifier: MIT
// Readers of the line-based surface formats OBJ and OFF, and of STL in both its forms.
#include "formats/surface/surface_plain.hpp"

#include "formats/surface/surface_text.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <map>

namespace palpate {
namespace {

using detail::same_word;
using detail::TextScan;

constexpr std::size_t kMostVertices = 0x7fffffff;

Eigen::Vector3d three_coordinates(PolygonSoup& soup, TextScan& scan, const std::string& what, bool over_lines) {
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) {
    const auto token = over_lines ? scan.token() : scan.word();
    point[axis] = scan.coordinate(token, what);
    detail::count_decimals(soup, token);
  }
  return point;
}

std::int32_t group_index(PolygonSoup& soup, std::string name) {
  if (name.empty()) name = "default";
  const auto found = std::find(soup.group_names.begin(), soup.group_names.end(), name);
  if (found == soup.group_names.end()) {
    soup.group_names.push_back(std::move(name));
    return static_cast<std::int32_t>(soup.group_names.size()) - 1;
  }
  return static_cast<std::int32_t>(found - soup.group_names.begin());
}

std::size_t count_obj_vertices(std::string_view text, const std::filesystem::path& file) {
  TextScan scan(text, file);
  std::size_t count = 0;
  while (scan.next_continued_line()) count += scan.word() == "v";
  return std::min(count, kMostVertices);
}

// Corners at the same place are one vertex, within a solid: the format has no indices.
class StlVertices {
public:
  explicit StlVertices(PolygonSoup& soup) : soup_(soup) {}
  void begin_solid() { known_.clear(); }
  void corner(const Eigen::Vector3d& p) {
    const auto [entry, fresh] =
        known_.try_emplace({p.x(), p.y(), p.z()}, static_cast<std::int32_t>(soup_.vertices.size()));
    if (fresh) soup_.vertices.push_back(p);
    soup_.corners.push_back(entry->second);
  }

private:
  PolygonSoup& soup_;
  std::map<std::array<double, 3>, std::int32_t> known_;
};

bool is_text_stl(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, 4);
  // Binary files that begin with "solid" are common; their size decides.
  if (bytes.size() >= 84 && bytes.size() == 84 + 50 * std::uint64_t(count)) return false;
  const std::string_view head = bytes.substr(0, 84);
  std::size_t begin = head.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  if (head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF")) return true;  // refused as text of 16 bits
  begin = head.find_first_not_of(" \t\r\n", begin);
  return begin != std::string_view::npos && same_word(bytes.substr(begin, 5), "solid") &&
         head.find('\0') == std::string_view::npos;
}

PolygonSoup read_binary_stl(std::string_view bytes, const std::filesystem::path& file) {
  if (bytes.size() < 84) {
    throw Error(ExitCode::bad_input, file.string() + ": not an STL file: no 'solid' line, and less than 84 bytes");
  }
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  const std::uint64_t expected = 84 + 50 * std::uint64_t(count);
  if (bytes.size() < expected) {
    throw Error(ExitCode::bad_input, file.string() + ": truncated or not an STL file: its header announces " +
                                         std::to_string(count) + " facets, " + std::to_string(expected) +
                                         " bytes, but the file has " + std::to_string(bytes.size()));
  }
  PolygonSoup soup;
  soup.single = true;
  soup.frame = stated_frame(bytes.substr(0, 80));
  StlVertices vertices(soup);
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
      vertices.corner({corner[0], corner[1], corner[2]});
    }
    detail::end_polygon(soup);
  }
  return soup;
}

// One facet behind the word "facet": everything may stand on one line, or on many.
void read_facet(PolygonSoup& soup, StlVertices& vertices, TextScan& scan, std::size_t facet) {
  const auto what = "facet " + std::to_string(facet);
  auto word = scan.token();
  while (!word.empty() && !same_word(word, "outer")) {  // normal and its numbers, which no one needs
    if (same_word(word, "facet") || same_word(word, "vertex")) scan.fail(what + ": 'outer loop' is missing");
    word = scan.token();
  }
  if (!same_word(scan.token(), "loop")) scan.fail(what + ": expected 'outer loop': truncated or damaged");
  word = scan.token();
  for (; same_word(word, "vertex"); word = scan.token()) vertices.corner(three_coordinates(soup, scan, what, true));
  if (!same_word(word, "endloop") || soup.corners.size() - soup.first.back() < 3) {
    scan.fail(what + ": expected 'vertex x y z', three times or more, then 'endloop': truncated or damaged");
  }
  if (!same_word(scan.token(), "endfacet")) scan.fail(what + ": expected 'endfacet': truncated or damaged");
}

PolygonSoup read_text_stl(std::string_view bytes, const std::filesystem::path& file) {
  PolygonSoup soup;
  StlVertices vertices(soup);
  TextScan scan(bytes, file);
  std::size_t facets = 0;
  bool open = false;
  std::int32_t solid = 0;
  std::vector<std::string> names;
  for (auto word = scan.token(); !word.empty(); word = scan.token()) {
    while (same_word(word, "solid")) {
      if (open) scan.fail("'solid' before 'endsolid'");
      open = true;
      std::string name;
      for (word = scan.word(); !word.empty() && !same_word(word, "facet"); word = scan.word()) {
        (name += name.empty() ? "" : " ") += word;
      }
      if (soup.frame == Frame::unstated) soup.frame = stated_frame(name);
      names.push_back(name);
      solid = group_index(soup, name.empty() ? file.stem().string() : name);
      vertices.begin_solid();
      if (word.empty()) word = scan.token();
    }
    if (word.empty()) break;
    if (same_word(word, "facet")) {
      if (!open) scan.fail("a facet outside of 'solid' and 'endsolid'");
      read_facet(soup, vertices, scan, facets++);
      if (detail::end_polygon(soup)) soup.groups.push_back(solid);
    } else if (same_word(word, "endsolid")) {
      while (!scan.word().empty()) continue;
      open = false;
    } else if (same_word(word, "color")) {
      while (!scan.word().empty()) continue;
    } else {
      scan.fail("'" + std::string(word.substr(0, 32)) + "' where a facet or 'endsolid' was expected: damaged");
    }
  }
  if (open) soup.notes.emplace_back("the file has no 'endsolid': it may be cut short");
  if (names.size() < 2) {  // one solid goes by the file's name, as in every format without names
    soup.groups.clear();
    soup.group_names.clear();
  }
  return soup;
}

}  // namespace

PolygonSoup read_obj(std::string_view text, const std::filesystem::path& file) {
  const auto total = static_cast<std::int64_t>(count_obj_vertices(text, file));
  PolygonSoup soup;
  TextScan scan(text, file);
  std::string object, group;
  bool named = false;
  while (scan.next_continued_line()) {
    if (scan.rest().find('\0') != std::string_view::npos) scan.fail("a zero byte: not an OBJ file");
    if (scan.rest().starts_with('#') && soup.frame == Frame::unstated) soup.frame = stated_frame(scan.rest());
    const auto key = scan.word();
    if (key == "v" || key == "f") scan.drop_comment();
    if (key == "v") {
      soup.vertices.push_back(
          three_coordinates(soup, scan, "vertex " + std::to_string(soup.vertices.size() + 1), false));
    } else if (key == "o" || key == "g") {
      (key == "o" ? object : group) = scan.rest();
      if (key == "o") group.clear();
      named = true;
    } else if (key == "f") {
      for (auto token = scan.word(); !token.empty(); token = scan.word()) {
        const auto index = scan.integer(token.substr(0, token.find('/')), "face");
        const auto vertex = index < 0 ? static_cast<std::int64_t>(soup.vertices.size()) + index + 1 : index;
        if (vertex < 1 || vertex > total) {
          scan.fail("vertex index " + std::to_string(index) + " is outside 1.." + std::to_string(total));
        }
        soup.corners.push_back(std::int32_t(vertex - 1));
      }
      if (soup.corners.size() - soup.first.back() < 3) scan.fail("a face needs at least three corners");
      if (!detail::end_polygon(soup)) continue;
      if (named) {
        soup.groups.push_back(group_index(soup, group.empty() ? object : group));
      } else {
        soup.groups.push_back(group_index(soup, file.stem().string()));
      }
    }
  }
  return soup;
}

PolygonSoup read_off(std::string_view text, const std::filesystem::path& file) {
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
  if (vertices > std::int64_t(kMostVertices)) scan.fail("more than 2^31 vertices");
  PolygonSoup soup;
  for (std::int64_t vertex = 0; vertex < vertices; ++vertex) {
    must("vertex " + std::to_string(vertex) + " of " + std::to_string(vertices));
    soup.vertices.push_back(three_coordinates(soup, scan, "vertex " + std::to_string(vertex), false));
  }
  for (std::int64_t face = 0; face < faces; ++face) {
    must("face " + std::to_string(face) + " of " + std::to_string(faces));
    const auto count = scan.integer(scan.word(), "face " + std::to_string(face));
    if (count < 3) scan.fail("face " + std::to_string(face) + " has " + std::to_string(count) + " corners, needs 3");
    for (std::int64_t corner = 0; corner < count; ++corner) {
      const auto index = scan.integer(scan.word(), "face " + std::to_string(face));
      if (index < 0 || index >= vertices) {
        scan.fail("face " + std::to_string(face) + ": vertex index " + std::to_string(index) + " is outside 0.." +
                  std::to_string(vertices - 1));
      }
      soup.corners.push_back(std::int32_t(index));
    }
    detail::end_polygon(soup);
  }
  return soup;
}

PolygonSoup read_stl(std::string_view bytes, const std::filesystem::path& file) {
  static_assert(std::endian::native == std::endian::little, "binary STL is read in place");
  return is_text_stl(bytes) ? read_text_stl(bytes, file) : read_binary_stl(bytes, file);
}

}  // namespace palpate
