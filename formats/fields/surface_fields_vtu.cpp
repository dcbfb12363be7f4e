// SPDX-License-Identifier: MIT
// VTK's XML unstructured grid of a surface with fields, as text.
#include "formats/fields/surface_fields.hpp"
#include "formats/io/error.hpp"
#include "formats/io/file.hpp"

#include <algorithm>
#include <charconv>

namespace palpate {
namespace {

template <class Number>
void put(std::string& text, Number number) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, number).ptr;  // as many digits as it takes
  text.append(digits, end);
}

/// One array, a line for each of `count` tuples that `tuple(i)` gives.
template <class Tuple>
void array(std::string& text, const std::string& attributes, std::size_t count, const Tuple& tuple) {
  text += "<DataArray " + attributes + " format=\"ascii\">\n";
  for (std::size_t i = 0; i < count; ++i) {
    for (const auto& number : tuple(i)) {
      put(text, number);
      text += ' ';
    }
    text.back() = '\n';
  }
  text += "</DataArray>\n";
}

template <class Number>
std::array<Number, 1> one(Number number) {
  return {number};
}

}  // namespace

void write_vtu(const SurfaceFields& s, const std::string& shown, const std::filesystem::path& path) {
  if (std::none_of(s.fields.begin(), s.fields.end(), [&](const SurfaceField& f) { return f.name == shown; })) {
    throw Error(ExitCode::bad_input, path.string() + ": no field '" + shown + "'");
  }
  const std::size_t points = s.points.size(), cells = s.triangles.size();
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "<UnstructuredGrid>\n<FieldData>\n";
  for (const auto& [name, number] : s.numbers) {
    array(text, "type=\"Float64\" Name=\"" + name + "\" NumberOfTuples=\"1\"", 1,
          [n = number](std::size_t) { return one(n); });
  }
  text += "</FieldData>\n<Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfCells=\"" +
          std::to_string(cells) + "\">\n<PointData Scalars=\"" + shown + "\" Normals=\"normal\">\n";
  for (const SurfaceField& f : s.fields) {
    if (!f.unit.empty()) text += "<!-- " + f.name + " in " + f.unit + " -->\n";
    array(text, "type=\"Float32\" Name=\"" + f.name + "\"", points, [&](std::size_t i) { return one(f.values[i]); });
  }
  const std::string three = " NumberOfComponents=\"3\"";
  array(text, "type=\"Float32\" Name=\"normal\"" + three, points, [&](std::size_t i) { return s.normals[i]; });
  text += "</PointData>\n<Points>\n";
  array(text, "type=\"Float32\" Name=\"points\"" + three, points, [&](std::size_t i) { return s.points[i]; });
  text += "</Points>\n<Cells>\n";
  constexpr int kTriangle = 5;  // VTK_TRIANGLE
  array(text, "type=\"Int64\" Name=\"connectivity\"", cells, [&](std::size_t i) { return s.triangles[i]; });
  array(text, "type=\"Int64\" Name=\"offsets\"", cells, [](std::size_t i) { return one(3 * (i + 1)); });
  array(text, "type=\"UInt8\" Name=\"types\"", cells, [](std::size_t) { return one(kTriangle); });
  text += "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  write_file(path, text);
}

}  // namespace palpate
