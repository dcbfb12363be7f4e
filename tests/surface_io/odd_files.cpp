// SPDX-License-Identifier: GPL-3.0-or-later
// Files of the kinds that programs really write: every one is a box, or refused by the name of what is not read.
#include "tests/support/shapes.hpp"
#include "tests/surface_io/glb.hpp"
#include "tests/surface_io/scratch.hpp"

#include <algorithm>
#include <cstring>
#include <sstream>

namespace palpate::test {
namespace {

const Surface kBox = box_surface({0, 0, 0}, {1, 2, 3});

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string text_stl(const Surface& s, const std::string& name) {
  std::ostringstream out;
  out.precision(17);
  out << "solid " << name << "\n";
  for (const auto& t : s.triangles) {
    out << "facet normal 0 0 0\nouter loop\n";
    for (const auto v : t) out << "vertex " << s.vertices[std::size_t(v)].transpose() << "\n";
    out << "endloop\nendfacet\n";
  }
  out << "endsolid " << name << "\n";
  return out.str();
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::toupper(c)); });
  return text;
}

TEST(OddStl, EverySpellingIsRead) {
  const Scratch scratch;
  const std::string plain = text_stl(kBox, "box");
  const std::vector<std::pair<std::string, std::string>> all{
      {"upper", upper(plain)},
      {"blank", "  \n " + plain},
      {"mark", "\xEF\xBB\xBF" + plain},
      {"lines", replaced(plain, "\n", "\n\n")},
      {"one_line", replaced(plain, "\n", " ")},
      {"old_ends", replaced(plain, "\n", "\r")},
      {"windows", replaced(plain, "\n", "\r\n")},
      {"nameless", replaced(plain, " box", "")},
  };
  for (const auto& [name, text] : all) {
    SCOPED_TRACE(name);
    const Surface s = read(scratch.write(name + ".stl", text));
    EXPECT_NEAR(surface_volume(s), 6, 1e-12);
    EXPECT_EQ(s.vertices.size(), 8U);
    EXPECT_TRUE(s.notes.empty());
  }
  const Surface cut = read(scratch.write("end.stl", plain.substr(0, plain.find("endsolid"))));
  EXPECT_NEAR(surface_volume(cut), 6, 1e-12);
  ASSERT_EQ(cut.notes.size(), 1U);
  expect_error([&] { read(scratch.write("torn.stl", plain.substr(0, plain.size() / 2))); }, ExitCode::bad_input,
               {"torn.stl"});
  expect_error([&] { read(scratch.write("wide.stl", std::string("\xFF\xFEs\0o\0l\0i\0d\0", 12))); },
               ExitCode::bad_input, {"16 bits"});
}

TEST(OddStl, TwoSolidsAreTwoMeshes) {
  const Scratch scratch;
  const auto file = scratch.write(
      "two.stl", text_stl(kBox, "wall") + text_stl(box_surface({0.2, 0.2, 0.2}, {0.4, 0.4, 0.4}), "lump of it"));
  EXPECT_EQ(read(file).part_names, (std::vector<std::string>{"wall", "lump of it"}));
  EXPECT_NEAR(surface_volume(read(file, {"wall"})), 6, 1e-12);
  EXPECT_NEAR(surface_volume(read(file, {"lump of it"})), 0.008, 1e-12);
}

std::string obj(const Surface& s) {
  std::ostringstream out;
  out.precision(17);
  for (const auto& v : s.vertices) out << "v " << v.transpose() << "\n";
  for (const auto& t : s.triangles) out << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  return out.str();
}

TEST(OddObj, MarksOldLineEndsAndContinuedLines) {
  const Scratch scratch;
  const std::string plain = obj(kBox);
  for (const std::string& text : {"\xEF\xBB\xBF" + plain, replaced(plain, "\n", "\r"), replaced(plain, "f ", "f \\\n "),
                                  replaced(plain, "f ", "f \\\r\n ")}) {
    EXPECT_NEAR(surface_volume(read(scratch.write("a.obj", text))), 6, 1e-12);
  }
  EXPECT_EQ(read(scratch.write("b.obj", "# 3D Slicer output. SPACE=LPS\n" + plain)).frame, Frame::lps);
  EXPECT_EQ(read(scratch.write("c.obj", plain)).frame, Frame::unstated);
}

// The roof of a prism over an L: a fan from its first corner would cover ground outside.
TEST(OddObj, AConcavePolygonIsCoveredOnce) {
  const Scratch scratch;
  const std::vector<Eigen::Vector2d> ground{{2, 2}, {0, 2}, {0, 0}, {1, 0}, {1, 1}, {2, 1}};
  std::ostringstream out;
  for (const double z : {0.0, 1.0}) {
    for (const auto& p : ground) out << "v " << p.x() << " " << p.y() << " " << z << "\n";
  }
  out << "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n";
  for (int k = 0; k < 6; ++k) {
    const int a = k + 1, b = (k + 1) % 6 + 1;
    out << "f " << a << " " << b << " " << b + 6 << " " << a + 6 << "\n";
  }
  const Surface s = read(scratch.write("l.obj", out.str()));
  EXPECT_NEAR(surface_volume(s), 3, 1e-12);
  double area = 0;
  for (const auto& t : s.triangles) {
    area += (s.vertices[std::size_t(t[1])] - s.vertices[std::size_t(t[0])])
                .cross(s.vertices[std::size_t(t[2])] - s.vertices[std::size_t(t[0])])
                .norm() /
            2;
  }
  EXPECT_NEAR(area, 2 * 3 + 8, 1e-12);
}

TEST(OddPly, ElementsAndPropertiesInAnyOrder) {
  const Scratch scratch;
  std::ostringstream points, faces, strips;
  for (const auto& v : kBox.vertices) points << v.transpose() << "\n";
  for (const auto& t : kBox.triangles) {
    faces << "2 0.5 0.5 7 3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
    strips << t[0] << " " << t[1] << " " << t[2] << " -1 ";
  }
  const std::string camera = "element camera 1\nproperty float view\n";
  const std::string vertex = "element vertex 8\nproperty int x\nproperty int y\nproperty int z\n";
  const std::string face =
      "element face 12\nproperty list uchar float texcoord\nproperty int flag\nproperty list uchar int vertex_index\n";
  const std::string head = "ply\nformat ascii 1.0\ncomment of a tool whose end_header lacked a line end\n";
  EXPECT_NEAR(surface_volume(read(scratch.write(
                  "a.ply", head + camera + vertex + face + "end_header\n1\n" + points.str() + faces.str()))),
              6, 1e-12);
  EXPECT_NEAR(
      surface_volume(read(scratch.write("b.ply", head + face + vertex + "end_header\n" + faces.str() + points.str()))),
      6, 1e-12);
  EXPECT_NEAR(surface_volume(read(scratch.write(
                  "c.ply", head + vertex + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                               points.str() + "48 " + strips.str() + "\n"))),
              6, 1e-12);
  const std::string old_ends =
      replaced(head + camera + vertex + face + "end_header\n1\n" + points.str() + faces.str(), "\n", "\r");
  EXPECT_NEAR(surface_volume(read(scratch.write("d.ply", "\xEF\xBB\xBF" + old_ends))), 6, 1e-12);
}

TEST(FarAway, DoublesKeepTheShapeAndFloatsAreRefused) {
  const Scratch scratch;
  const Eigen::Vector3d shift(431250, 5411980, 312);
  Surface ball = sphere_surface({0, 0, 0}, 0.05), far = ball;
  for (auto& v : far.vertices) v += shift;
  const double volume = surface_volume(ball);
  const auto near = [&](Surface s) {
    for (auto& v : s.vertices) v -= shift;
    EXPECT_NEAR(surface_volume(s) / volume, 1, 1e-6);
  };
  near(read(scratch.write("far.obj", obj(far))));
  near(read(scratch.write("far.stl", text_stl(far, "ball"))));
  write_surface(far, scratch / "binary.stl");
  expect_error([&] { read(scratch / "binary.stl"); }, ExitCode::bad_input, {"binary.stl", "lost in the file"});
  std::ostringstream coarse;
  coarse << std::fixed;
  coarse.precision(2);
  for (const auto& v : far.vertices) coarse << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
  const std::string faces = obj(far).substr(obj(far).find("f "));
  expect_error([&] { read(scratch.write("coarse.obj", coarse.str() + faces)); }, ExitCode::bad_input,
               {"coarse.obj", "lost in the file"});
}

TEST(OddGltf, QuantisedAndSparsePositionsAreRead) {
  const Scratch scratch;
  Glb glb;
  glb.mesh("box", kBox);
  // Shorts, normalised: the node's scale brings them back.
  const auto quantised = [&] {
    Glb g = glb;
    std::string bytes;
    for (const auto& v : kBox.vertices) {
      for (int k = 0; k < 3; ++k) Glb::put(bytes, std::uint16_t(std::lround(v[k] / 3 * 65535)));
      Glb::put(bytes, std::uint16_t{0});
    }
    const int at = g.view(bytes);
    g.json["bufferViews"][at]["byteStride"] = 8;
    g.json["accessors"][0]["bufferView"] = at;
    g.json["accessors"][0]["byteOffset"] = 0;
    g.json["accessors"][0]["componentType"] = 5123;
    g.json["accessors"][0]["normalized"] = true;
    g.json["nodes"][0]["scale"] = {3, 3, 3};
    g.json["extensionsRequired"] = {"KHR_mesh_quantization", "KHR_texture_basisu"};
    return g.bytes();
  };
  EXPECT_NEAR(surface_volume(read(scratch.write("q.glb", quantised()))), 6, 1e-3);
  const auto sparse = [&] {
    Glb g = glb;
    std::string places, values;
    for (std::uint16_t k = 0; k < 8; ++k) {
      Glb::put(places, k);
      for (int a = 0; a < 3; ++a) Glb::put(values, float(kBox.vertices[k][a]));
    }
    const int at = g.view(places), more = g.view(values);
    g.json["accessors"][0].erase("bufferView");
    g.json["accessors"][0]["sparse"] = {
        {"count", 8}, {"indices", {{"bufferView", at}, {"componentType", 5123}}}, {"values", {{"bufferView", more}}}};
    return g.bytes();
  };
  EXPECT_NEAR(surface_volume(read(scratch.write("s.glb", sparse()))), 6, 1e-6);
}

}  // namespace
}  // namespace palpate::test
