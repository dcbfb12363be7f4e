// SPDX-License-Identifier: GPL-3.0-or-later
// OBJ, OFF, PLY and STL: what is in the file arrives unchanged.
#include "tests/support/shapes.hpp"
#include "tests/surface_io/scratch.hpp"

#include <bit>
#include <cstring>

namespace palpate::test {
namespace {

// A box with a fin, a doubled face and a flipped face: all of it must survive.
Surface awkward() {
  Surface s = box_surface({0, 0, 0}, {0.1, 0.2, 0.3}, 2);
  s.vertices.emplace_back(0.5, 0.5, 0.5);
  const auto tip = std::int32_t(s.vertices.size()) - 1;
  s.triangles.push_back({s.triangles[0][0], s.triangles[0][1], tip});
  s.triangles.push_back(s.triangles[3]);
  std::swap(s.triangles[5][0], s.triangles[5][1]);
  set_one_part(s, "awkward");
  return s;
}

class PlainFormat : public testing::TestWithParam<std::string> {};

TEST_P(PlainFormat, NonManifoldSoupSurvivesARoundTrip) {
  const Scratch scratch;
  const auto file = scratch / ("awkward" + GetParam());
  const Surface before = awkward();
  write_surface(before, file);
  const Surface after = read(file);
  ASSERT_EQ(after.triangles.size(), before.triangles.size());
  EXPECT_EQ(after.vertices.size(), before.vertices.size());  // STL welded by position: the same points
  for (std::size_t t = 0; t < before.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& p = before.vertices[std::size_t(before.triangles[t][k])];
      const auto& q = after.vertices[std::size_t(after.triangles[t][k])];
      EXPECT_LE((p - q).norm(), 1e-7) << t;
    }
    if (GetParam() != ".stl") {
      EXPECT_EQ(after.triangles[t], before.triangles[t]);
    }
  }
  EXPECT_EQ(after.part_names, std::vector<std::string>{"awkward"});
  EXPECT_EQ(after.parts, std::vector<std::int32_t>(after.triangles.size(), 0));
}

TEST_P(PlainFormat, UnitScalesTheCoordinates) {
  const Scratch scratch;
  const auto file = scratch / ("box" + GetParam());
  write_surface(box_surface({0, 0, 0}, {10, 20, 30}), file);
  EXPECT_NEAR(surface_volume(read(file, {}, 1e-3)), 6000e-9, 1e-15);
}

INSTANTIATE_TEST_SUITE_P(All, PlainFormat, testing::Values(".obj", ".off", ".ply", ".stl"),
                         [](const auto& one) { return one.param.substr(1); });

TEST(Obj, GroupsQuadsNegativeIndicesAndComments) {
  const Scratch scratch;
  const auto file = scratch.write("pyramid.obj",
                                  "# a pyramid\r\nmtllib /dev/zero\n  v 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv +0 1e0 0 # c\n"
                                  "vn 0 0 1\nvt 0 0\ng base\nusemtl x\nf 4//1 3//1 2//1 1//1\nv .5 .5 1\n"
                                  "g sides\nf -5/1/1 -4/1/1 -1/1/1\nf 2 3 5\nf 3 4 5\ng base\nf 4 1 5\n");
  const Surface s = read(file);
  EXPECT_EQ(s.vertices.size(), 5U);
  ASSERT_EQ(s.triangles.size(), 6U);
  EXPECT_EQ(s.triangles[2], (std::array<std::int32_t, 3>{0, 1, 4}));
  EXPECT_EQ(s.part_names, (std::vector<std::string>{"base", "sides"}));
  EXPECT_EQ(s.parts, (std::vector<std::int32_t>{0, 0, 1, 1, 1, 0}));
  EXPECT_NEAR(surface_volume(s), 1.0 / 3, 1e-6);
  const Surface sides = read(file, {"sides"});
  EXPECT_EQ(sides.triangles.size(), 3U);
  EXPECT_EQ(sides.part_names, std::vector<std::string>{"sides"});
  expect_error([&] { read(file, {"top"}); }, ExitCode::bad_input, {"pyramid.obj", "'top'", "base, sides"});
}

TEST(Off, CommentsColoursAndCountsOnTheFirstLine) {
  const Scratch scratch;
  const auto file =
      scratch.write("a.off", "# c\nOFF 4 2 0 # x\n\n0 0 0\n# y\n1 0 0 255 0 0\n0 1 0\n0 0 1\n3 0 1 2 9 9 9\n3 1 2 3\n");
  const Surface s = read(file);
  EXPECT_EQ(s.vertices.size(), 4U);
  EXPECT_EQ(s.triangles, (std::vector<std::array<std::int32_t, 3>>{{0, 1, 2}, {1, 2, 3}}));
}

template <class Number>
void put(std::string& out, Number value, bool big) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (big) std::reverse(raw, raw + sizeof value);
  out.append(raw, sizeof value);
}

std::string binary_ply(bool big, bool doubles, bool colours) {
  const std::string type = doubles ? "double" : "float";
  std::string out = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                    "_endian 1.0\ncomment c\nelement vertex 4\nproperty " + type + " x\nproperty " + type +
                    " y\nproperty " + type + " z\nproperty float quality\nelement face 2\n" +
                    "property list uchar int vertex_indices\n" + (colours ? "property uchar red\n" : "") +
                    "end_header\n";
  const double points[4][3] = {{0.25, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const auto& p : points) {
    for (const double x : p) doubles ? put(out, x, big) : put(out, float(x), big);
    put(out, 7.0F, big);
  }
  for (const auto& f : {std::array{0, 1, 2}, std::array{1, 2, 3}}) {
    out += '\3';
    for (const int v : f) put(out, v, big);
    if (colours) out += '\x7f';
  }
  return out;
}

TEST(Ply, BinaryInBothOrdersAndBothPrecisions) {
  const Scratch scratch;
  for (int form = 0; form < 8; ++form) {
    const auto file = scratch.write("b.ply", binary_ply(form & 1, form & 2, form & 4));
    const Surface s = read(file);
    ASSERT_EQ(s.vertices.size(), 4U) << form;
    EXPECT_EQ(s.vertices[0], Eigen::Vector3d(0.25, 0, 0)) << form;
    EXPECT_EQ(s.triangles, (std::vector<std::array<std::int32_t, 3>>{{0, 1, 2}, {1, 2, 3}})) << form;
  }
}

TEST(Stl, TextFormAndHeaderThatLies) {
  const Scratch scratch;
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  const Surface text = read(scratch.write("t.stl", "solid a b\n" + facet + facet + "endsolid a b\n"));
  EXPECT_EQ(text.triangles.size(), 2U);
  EXPECT_EQ(text.vertices.size(), 3U);
  // Binary files that begin with "solid" are common; their size identifies them.
  write_surface(box_surface({0, 0, 0}, {1, 1, 1}), scratch / "box.stl");
  std::ifstream stream(scratch / "box.stl", std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  bytes.replace(0, 6, "solid ");
  EXPECT_NEAR(surface_volume(read(scratch.write("solid.stl", bytes))), 1.0, 1e-6);
}

TEST(SurfaceIo, UppercaseExtension) {
  const Scratch scratch;
  write_surface(box_surface({0, 0, 0}, {1, 1, 1}), scratch / "BOX.PLY");
  EXPECT_EQ(read(scratch / "BOX.PLY").triangles.size(), 12U);
}

}  // namespace
}  // namespace palpate::test
