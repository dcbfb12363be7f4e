// SPDX-License-Identifier: GPL-3.0-or-later
// VTK's polydata in every form that it is written in, damaged ones, and the grid of a solved contact.
#include "formats/fields/volume_vtu.hpp"
#include "tests/support/shapes.hpp"
#include "tests/surface_io/scratch.hpp"

#include <zlib.h>

#include <cstring>
#include <sstream>

namespace palpate::test {
namespace {

const Surface kVtkBox = box_surface({0, 0, 0}, {1, 2, 3});

template <class Number>
std::string raw_numbers(const std::vector<Number>& numbers, bool big) {
  std::string out;
  for (const Number number : numbers) {
    char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    if (big) std::reverse(bytes, bytes + sizeof number);
    out.append(bytes, sizeof number);
  }
  return out;
}

std::string base64(const std::string& bytes) {
  static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t bits = 0;
    for (std::size_t b = 0; b < 3; ++b) {
      bits = bits << 8 | (k + b < bytes.size() ? static_cast<unsigned char>(bytes[k + b]) : 0U);
    }
    for (std::size_t q = 0; q < 4; ++q) out += k + q > bytes.size() ? '=' : digits[bits >> (18 - 6 * q) & 63];
  }
  return out;
}

std::vector<float> points() {
  std::vector<float> all;
  for (const auto& v : kVtkBox.vertices) {
    for (const double x : v) all.push_back(float(x));
  }
  return all;
}

std::vector<std::int64_t> connectivity() {
  std::vector<std::int64_t> all;
  for (const auto& t : kVtkBox.triangles) all.insert(all.end(), t.begin(), t.end());
  return all;
}

std::vector<std::int64_t> offsets(bool from_zero) {
  std::vector<std::int64_t> all;
  for (std::size_t k = from_zero ? 0 : 1; k <= kVtkBox.triangles.size(); ++k) all.push_back(std::int64_t(3 * k));
  return all;
}

template <class Number>
std::string words(const std::vector<Number>& numbers) {
  std::ostringstream out;
  for (const Number n : numbers) out << n << " ";
  return out.str();
}

std::string legacy(bool binary, bool new_cells) {
  const std::string head = std::string("# vtk DataFile Version ") + (new_cells ? "5.1" : "3.0") +
                           "\n3D Slicer output. SPACE=LPS\n" + (binary ? "BINARY" : "ASCII") +
                           "\nDATASET POLYDATA\nPOINTS 8 float\n";
  std::string out = head + (binary ? raw_numbers(points(), true) : words(points())) + "\nMETADATA\nINFORMATION 0\n\n";
  const auto count = std::to_string(kVtkBox.triangles.size());
  if (new_cells) {
    out += "POLYGONS " + std::to_string(kVtkBox.triangles.size() + 1) + " 36\nOFFSETS vtktypeint64\n" +
           (binary ? raw_numbers(offsets(true), true) : words(offsets(true))) + "\nCONNECTIVITY vtktypeint64\n" +
           (binary ? raw_numbers(connectivity(), true) : words(connectivity())) + "\n";
  } else {
    std::vector<std::int32_t> mixed;
    for (const auto& t : kVtkBox.triangles) mixed.insert(mixed.end(), {3, t[0], t[1], t[2]});
    out += "POLYGONS " + count + " 48\n" + (binary ? raw_numbers(mixed, true) : words(mixed)) + "\n";
  }
  return out + "\nPOINT_DATA 8\nSCALARS x float\n";
}

TEST(VtkFiles, LegacyTextAndBinaryOfBothVersions) {
  const Scratch scratch;
  for (const bool binary : {false, true}) {
    for (const bool new_cells : {false, true}) {
      const Surface s = read(scratch.write("box.vtk", legacy(binary, new_cells)));
      EXPECT_NEAR(surface_volume(s), 6, 1e-12) << binary << new_cells;
      EXPECT_EQ(s.frame, Frame::lps);
    }
  }
}

enum class Form { text, base64, zlib, appended, raw };

std::string xml(Form form) {
  std::string appended;
  const auto packed = [](const std::string& bytes) {
    std::string out(compressBound(uLong(bytes.size())), '\0');
    auto size = uLongf(out.size());
    compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
             uLong(bytes.size()));
    return out.substr(0, size);
  };
  const auto array = [&](const std::string& type, const std::string& name, const std::string& bytes,
                         const std::string& text) {
    const std::string head = "<DataArray type=\"" + type + "\" Name=\"" + name + "\"";
    const std::string length = raw_numbers<std::uint32_t>({std::uint32_t(bytes.size())}, false);
    switch (form) {
      case Form::text:
        return head + " format=\"ascii\">\n" + text + "\n</DataArray>\n";
      case Form::base64:
        return head + " format=\"binary\">\n" + base64(length + bytes) + "\n</DataArray>\n";
      case Form::zlib: {
        const std::string data = packed(bytes);
        const auto size = std::uint32_t(bytes.size());
        return head + " format=\"binary\">\n" +
               base64(raw_numbers<std::uint32_t>({1, size, size, std::uint32_t(data.size())}, false)) + base64(data) +
               "\n</DataArray>\n";
      }
      default:
        break;
    }
    const auto at = std::to_string(appended.size());
    appended += form == Form::raw ? length + bytes : base64(length + bytes);
    return head + " format=\"appended\" offset=\"" + at + "\"/>\n";
  };
  const bool zlib = form == Form::zlib;
  std::string out = std::string(
                        "<?xml version=\"1.0\"?>\n<!-- SPACE=RAS -->\n<VTKFile type=\"PolyData\" "
                        "version=\"0.1\" byte_order=\"LittleEndian\"") +
                    (zlib ? " compressor=\"vtkZLibDataCompressor\"" : "") +
                    ">\n<PolyData>\n<Piece NumberOfPoints=\"8\" NumberOfPolys=\"12\">\n<PointData>\n" +
                    array("Float32", "quality", raw_numbers(points(), false), words(points())) +
                    "</PointData>\n<Points>\n" +
                    array("Float32", "Points", raw_numbers(points(), false), words(points())) + "</Points>\n<Polys>\n" +
                    array("Int64", "connectivity", raw_numbers(connectivity(), false), words(connectivity())) +
                    array("Int64", "offsets", raw_numbers(offsets(false), false), words(offsets(false))) +
                    "</Polys>\n</Piece>\n</PolyData>\n";
  if (!appended.empty()) {
    out += std::string("<AppendedData encoding=\"") + (form == Form::raw ? "raw" : "base64") + "\">\n_" + appended +
           "\n</AppendedData>\n";
  }
  return out + "</VTKFile>\n";
}

TEST(VtkFiles, XmlInEveryEncoding) {
  const Scratch scratch;
  for (const Form form : {Form::text, Form::base64, Form::zlib, Form::appended, Form::raw}) {
    const Surface s = read(scratch.write("box.vtp", xml(form)));
    EXPECT_NEAR(surface_volume(s), 6, 1e-12) << int(form);
    EXPECT_EQ(s.frame, Frame::ras);
  }
}

TEST(VtkFiles, EveryTruncationIsRefused) {
  const Scratch scratch;
  for (const Form form : {Form::base64, Form::zlib, Form::raw}) {
    const std::string good = xml(form);
    const std::size_t needed = form == Form::raw ? good.find("</AppendedData>") - 1 : good.find("</Polys>") - 13;
    for (std::size_t length = 1; length < needed; length += 7) {
      const auto file = scratch.write("cut.vtp", good.substr(0, length));
      expect_error([&] { read(file); }, ExitCode::bad_input, {"cut.vtp"});
    }
  }
  const std::string good = legacy(true, true);
  for (std::size_t length = 1; length < good.find("POINT_DATA") - 2; length += 7) {
    const auto file = scratch.write("cut.vtk", good.substr(0, length));
    expect_error([&] { read(file); }, ExitCode::bad_input, {"cut.vtk"});
  }
  const std::string lz4 = "<VTKFile type=\"PolyData\" compressor=\"vtkLZ4DataCompressor\"></VTKFile>";
  expect_error([&] { read(scratch.write("lz4.vtp", lz4)); }, ExitCode::bad_input, {"vtkLZ4DataCompressor"});
}

TEST(VtkFiles, VolumeGridHasStressAndDisplacement) {
  const Scratch scratch;
  VolumeFields v;
  v.points.assign(10, {0.25, 0, 0});
  v.tets = {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}};
  v.regions = {1};
  v.displacement.assign(10, {0, 0, -0.001});
  v.stress = {Eigen::Vector3d(100, 0, 0).asDiagonal()};
  v.jacobian = {1};
  EXPECT_NEAR(von_mises(v.stress[0]), 100, 1e-9);
  write_volume_vtu(v, scratch / "a.vtu");
  std::ifstream stream(scratch / "a.vtu");
  const std::string text((std::istreambuf_iterator<char>(stream)), {});
  for (const char* piece :
       {"NumberOfPoints=\"10\"", "0 0 -0.001\n", "100 0 0 0 0 0\n", "\n24\n", "Name=\"von_mises\""}) {
    EXPECT_NE(text.find(piece), std::string::npos) << piece;
  }
  v.stress.clear();
  expect_error([&] { write_volume_vtu(v, scratch / "b.vtu"); }, ExitCode::bad_input, {"different lengths"});
}

}  // namespace
}  // namespace palpate::test
