// SPDX-License-Identifier: MIT
// VTK's XML unstructured grid of ten-node tetrahedra, as text.
#include "formats/fields/volume_vtu.hpp"

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"

#include <charconv>
#include <cmath>

namespace palpate {
namespace {

constexpr int kQuadraticTetra = 24;  // VTK_QUADRATIC_TETRA, whose order of nodes is ours

template <class Number>
void put_number(std::string& text, Number number) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
  text += ' ';
}

/// An array of `count` lines, which `line(i)` appends to the text.
template <class Line>
void put_array(std::string& text, const std::string& attributes, std::size_t count, const Line& line) {
  text += "<DataArray " + attributes + " format=\"ascii\">\n";
  for (std::size_t i = 0; i < count; ++i) {
    line(i);
    text.back() = '\n';
  }
  text += "</DataArray>\n";
}

}  // namespace

double von_mises(const Eigen::Matrix3d& s) {
  const Eigen::Matrix3d deviator = s - s.trace() / 3 * Eigen::Matrix3d::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

void write_volume_vtu(const VolumeFields& v, const std::filesystem::path& path) {
  const std::size_t points = v.points.size(), cells = v.tets.size();
  if (v.displacement.size() != points || v.regions.size() != cells || v.stress.size() != cells ||
      v.jacobian.size() != cells) {
    throw Error(ExitCode::bad_input, path.string() + ": lists of points or cells are of different lengths");
  }
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "<UnstructuredGrid>\n<FieldData>\n";
  for (const auto& [name, number] : v.numbers) {
    put_array(text, "type=\"Float64\" Name=\"" + name + "\" NumberOfTuples=\"1\"", 1,
              [&, n = number](std::size_t) { put_number(text, n); });
  }
  const auto scalar = [](const char* name, const char* type = "Float64") {
    return std::string("type=\"") + type + "\" Name=\"" + name + "\"";
  };
  const auto vector = [&](const std::vector<Eigen::Vector3d>& all, const char* name) {
    put_array(text, scalar(name) + " NumberOfComponents=\"3\"", all.size(), [&](std::size_t i) {
      for (const double x : all[i]) put_number(text, x);
    });
  };
  text += "</FieldData>\n<Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfCells=\"" +
          std::to_string(cells) + "\">\n<PointData Vectors=\"displacement\">\n<!-- m -->\n";
  vector(v.displacement, "displacement");
  text += "</PointData>\n<CellData Scalars=\"von_mises\">\n<!-- stresses in Pa -->\n";
  put_array(text, scalar("region", "Int32"), cells, [&](std::size_t i) { put_number(text, v.regions[i]); });
  put_array(text, scalar("von_mises"), cells, [&](std::size_t i) { put_number(text, von_mises(v.stress[i])); });
  put_array(text, scalar("pressure"), cells, [&](std::size_t i) { put_number(text, -v.stress[i].trace() / 3); });
  put_array(text, scalar("jacobian"), cells, [&](std::size_t i) { put_number(text, v.jacobian[i]); });
  put_array(text, scalar("stress") + " NumberOfComponents=\"6\"", cells, [&](std::size_t i) {
    const Eigen::Matrix3d& s = v.stress[i];
    for (const double x : {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2)}) put_number(text, x);
  });
  text += "</CellData>\n<Points>\n";
  vector(v.points, "points");
  text += "</Points>\n<Cells>\n";
  put_array(text, scalar("connectivity", "Int64"), cells, [&](std::size_t i) {
    for (const auto node : v.tets[i]) put_number(text, node);
  });
  put_array(text, scalar("offsets", "Int64"), cells, [&](std::size_t i) { put_number(text, 10 * (i + 1)); });
  put_array(text, scalar("types", "UInt8"), cells, [&](std::size_t) { put_number(text, kQuadraticTetra); });
  text += "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  write_file(path, text);
}

}  // namespace palpate
