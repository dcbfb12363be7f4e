// SPDX-License-Identifier: MIT
// Line by line; every complaint names the line.
#include "formats/surface/curve_io.hpp"

#include "formats/io/file.hpp"
#include "formats/surface/surface_text.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace palpate {
namespace {

using detail::TextScan;

constexpr std::size_t kLargest = std::size_t{1} << 28U;

void add_piece(Curves& curves, std::int32_t from, std::int32_t to, const TextScan& scan) {
  const Eigen::Vector3d &a = curves.points[std::size_t(from)], &b = curves.points[std::size_t(to)];
  if (!((b - a).norm() > 0)) scan.fail("a piece of the curve has no length");
  curves.pieces.push_back({from, to});
}

Eigen::Vector3d three_coordinates(TextScan& scan) {
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) point[axis] = scan.coordinate(scan.word(), "point");
  return point;
}

// Points that no piece uses are left out: nothing of them is wanted, and they would be in hashes.
Curves compacted(const Curves& all) {
  Curves used;
  std::vector<std::int32_t> number(all.points.size(), -1);
  for (const auto& piece : all.pieces) {
    auto& kept = used.pieces.emplace_back(piece);
    for (auto& point : kept) {
      auto& known = number[std::size_t(point)];
      if (known < 0) {
        known = static_cast<std::int32_t>(used.points.size());
        used.points.push_back(all.points[std::size_t(point)]);
      }
      point = known;
    }
  }
  return used;
}

Curves obj_curves(const std::string& text, const SurfaceSource& source) {
  Curves curves;
  TextScan scan(text, source.file);
  std::string name;
  std::vector<std::string> names;
  const auto wanted = [&] {
    return source.meshes.empty() || std::find(source.meshes.begin(), source.meshes.end(), name) != source.meshes.end();
  };
  // A line may stand before its points: they are read first.
  while (scan.next_line()) {
    if (scan.word() == "v") curves.points.push_back(three_coordinates(scan));
  }
  scan = TextScan(text, source.file);
  std::int64_t before = 0;
  while (scan.next_line()) {
    scan.drop_comment();
    const auto key = scan.word();
    before += key == "v";
    if (key == "o" || key == "g") {
      name = scan.rest();
    } else if (key == "l") {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
      std::vector<std::int32_t> line;
      for (auto token = scan.word(); !token.empty(); token = scan.word()) {
        const auto index = scan.integer(token.substr(0, token.find('/')), "line");
        const auto point = index < 0 ? before + index : index - 1;
        if (point < 0 || point >= static_cast<std::int64_t>(curves.points.size())) {
          scan.fail("vertex index " + std::to_string(index) + " is outside 1.." + std::to_string(curves.points.size()));
        }
        line.push_back(static_cast<std::int32_t>(point));
      }
      if (line.size() < 2) scan.fail("a line needs at least two points");
      for (std::size_t k = 0; wanted() && k + 1 < line.size(); ++k) add_piece(curves, line[k], line[k + 1], scan);
    }
  }
  for (const std::string& asked : source.meshes) {
    if (std::find(names.begin(), names.end(), asked) != names.end()) continue;
    std::string list;
    for (const auto& known : names) list += (list.empty() ? "" : ", ") + (known.empty() ? "(no name)" : known);
    throw Error(ExitCode::bad_input, source.file.string() + ": no lines named '" + asked + "'; there are: " + list);
  }
  return compacted(curves);
}

Curves read_table(std::string text, const SurfaceSource& source) {
  if (!source.meshes.empty()) throw Error(ExitCode::bad_input, source.file.string() + ": a table has no named curves");
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
  Curves curves;
  TextScan scan(text, source.file);
  bool first = true;
  while (scan.next_line()) {
    scan.drop_comment();
    const std::string row(scan.rest());
    if (row.empty()) continue;
    if (std::exchange(first, false) && row.find_first_of("xX") != std::string::npos) continue;
    curves.points.push_back(three_coordinates(scan));
    if (!scan.rest().empty()) scan.fail("a point has three coordinates, and nothing else");
    const auto last = static_cast<std::int32_t>(curves.points.size()) - 1;
    if (last > 0) add_piece(curves, last - 1, last, scan);
  }
  if (curves.points.size() == 1) scan.fail("one point is no curve: a curve needs at least two points");
  return curves;
}

}  // namespace

Curves read_curves(const SurfaceSource& source) {
  std::string extension = source.file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension != ".obj" && extension != ".csv") {
    throw Error(ExitCode::bad_input,
                source.file.string() + ": unknown curve format '" + extension + "' (allowed: .obj, .csv)");
  }
  const std::string text = read_file(source.file, "curve", kLargest);
  Curves curves = extension == ".obj" ? obj_curves(text, source) : read_table(text, source);
  if (curves.pieces.empty()) throw Error(ExitCode::bad_input, source.file.string() + ": there is no curve in it");
  for (auto& point : curves.points) point *= source.unit;
  return curves;
}

}  // namespace palpate
