// SPDX-License-Identifier: GPL-3.0-or-later
// Bad surface files behind a good scene: refused while the organ is prepared, with file and cause.
#include "tests/cli/palpate_program.hpp"

#include <ostream>

namespace palpate::test::surface_input_test {
namespace {

/// A closed box of 40 mm as OFF.
const std::string kBox =
    "OFF\n8 12 0\n0 0 0\n0.04 0 0\n0.04 0.04 0\n0 0.04 0\n0 0 0.04\n0.04 0 0.04\n0.04 0.04 0.04\n0 0.04 0.04\n"
    "3 0 2 1\n3 0 3 2\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n3 1 2 6\n3 1 6 5\n3 2 3 7\n3 2 7 6\n3 3 0 4\n3 3 4 7\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

/// A box of 20 mm inside it, without its lid; its rim is too bent for a cap.
const std::string kOpenBox =
    "OFF\n8 10 0\n.01 .01 .01\n.03 .01 .01\n.03 .03 .01\n.01 .03 .01\n.01 .01 .03\n.03 .01 .03\n.03 .03 .02\n"
    ".01 .03 .03\n3 0 2 1\n3 0 3 2\n3 0 1 5\n3 0 5 4\n3 1 2 6\n3 1 6 5\n3 2 3 7\n3 2 7 6\n3 3 0 4\n3 3 4 7\n";

struct Case {
  std::string name;
  std::string file;  ///< name of the surface file
  std::string content;
  std::string scene;  ///< follows [body] surface
  int code;
  std::vector<std::string> cause;
};

/// For the test's name and output; otherwise the bytes of the case are printed.
[[maybe_unused]] void PrintTo(const Case& test_case, std::ostream* out) { *out << test_case.name; }

const std::vector<Case> kCases{
    {"empty", "a.off", "", "", 2, {"a.off", "empty"}},
    {"truncated off", "a.off", kBox.substr(0, kBox.size() / 2), "", 2, {"a.off"}},
    {"truncated ply",
     "a.ply",
     "ply\nformat binary_little_endian 1.0\nelement vertex 100\nproperty float x\n",
     "",
     2,
     {"a.ply"}},
    {"garbage stl", "a.stl", std::string(200, '\xee'), "", 2, {"a.stl"}},
    {"garbage glb", "a.glb", std::string("glTF\x02\x00\x00\x00\xff\xff\xff\x7f garbage", 20), "", 2, {"a.glb"}},
    {"garbage obj", "a.obj", std::string("\x00\x01\x02\x03\x04", 5), "", 2, {"a.obj"}},
    {"unknown format", "a.fbx", "x", "", 2, {"a.fbx", ".glb"}},
    {"not a number", "a.off", replaced(kBox, "0.04 0.04 0.04", "nan 0.04 0.04"), "", 2, {"a.off"}},
    {"index out of range", "a.off", replaced(kBox, "3 0 2 1", "3 0 2 99"), "", 2, {"a.off", "99"}},
    {"no faces", "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "", 2, {"a.obj", "no triangles"}},
    {"open and not to be repaired",
     "a.off",
     replaced(replaced(kBox, "8 12 0", "8 11 0"), "3 3 4 7\n", ""),
     "repair = \"none\"\n",
     2,
     {"repair"}},
    {"inside out",
     "a.off",
     "OFF\n4 4 0\n0 0 0\n0.04 0 0\n0 0.04 0\n0 0 0.04\n3 0 1 2\n3 0 3 1\n3 0 2 3\n3 1 3 2\n",
     "repair = \"none\"\n",
     2,
     {"a.off", "inside out"}},
    {"one triangle turned",
     "a.off",
     replaced(kBox, "3 0 2 1", "3 0 1 2"),
     "repair = \"none\"\n",
     2,
     {"a.off", "face opposite ways"}},
    {"three triangles at an edge",
     "a.off",
     replaced(replaced(kBox, "8 12 0", "8 13 0"), "3 0 2 1", "3 0 1 6\n3 0 2 1"),
     "repair = \"none\"\n",
     2,
     {"a.off", "more than two triangles"}},
    {"self-intersecting",
     "a.off",
     replaced(kBox, "0.04 0.04 0.04", "-0.02 -0.02 -0.01"),
     "repair = \"none\"\n",
     2,
     {"a.off", "self-intersecting"}},
    {"missing mesh", "a.off", kBox, "meshes = [\"capsule\"]\n", 2, {"capsule", "there are"}},
    {"region that is open",
     "a.off",
     kBox,
     "[[region]]\nname = \"lump\"\nsurface = \"open.off\"\n",
     2,
     {"region 'lump'", "open.off", "open: 4 boundary edges", "no rim is flat enough"}},
    {"missing support mesh", "a.off", kBox, "[[support]]\nmesh = \"ligament\"\n", 2, {"ligament"}},
    {"missing region file", "a.off", kBox, "[[region]]\nsurface = \"none.ply\"\n", 4, {"none.ply", "No such file"}},
};

class BadSurface : public PalpateProgram, public testing::WithParamInterface<Case> {};

TEST_P(BadSurface, IsRefused) {
  write(GetParam().file, GetParam().content);
  write("open.off", kOpenBox);
  write("scene.toml", "[body]\nsurface = \"" + GetParam().file + "\"\n" + GetParam().scene);
  expect_failure(run({"mesh", "scene.toml", "--out", "out"}), GetParam().code, GetParam().cause);
  EXPECT_FALSE(std::filesystem::exists(folder() / "out"));
}

INSTANTIATE_TEST_SUITE_P(Table, BadSurface, testing::ValuesIn(kCases),
                         [](const auto& test_case) { return test_name(test_case.param.name); });

class TwoSurfaces : public PalpateProgram {};

TEST_F(TwoSurfaces, ThatIntersectOrTouchAreRefused) {
  write("a.off", kBox);
  const auto refused = [&](const std::string& second, const char* cause) {
    write("b.off", second);
    write("scene.toml", "[body]\nsurface = [\"a.off\", \"b.off\"]\nrepair = \"none\"\n");
    expect_failure(run({"mesh", "scene.toml", "--out", "out"}), 2, {"a.off + b.off", cause});
    EXPECT_FALSE(std::filesystem::exists(folder() / "out"));
  };
  // A tetrahedron through the box, the box again, and a box with one corner moved inwards, which shares walls.
  refused(
      "OFF\n4 4 0\n-0.01 0.02 0.02\n0.05 0.01 0.02\n0.05 0.03 0.02\n0.05 0.02 0.03\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 "
      "3\n",
      "self-intersecting");
  refused(kBox, "double another");
  refused(replaced(kBox, "0 0 0\n", "0.02 0.02 0.02\n"), "double another");
}

class Spacing : public PalpateProgram {};

TEST_F(Spacing, ThatIsTooFineForTheBodyAsksForItsUnits) {
  write("a.off", kBox);
  write("scene.toml", "[body]\nsurface = \"a.off\"\n[sampling]\nspacing = 1e-5\n");
  expect_failure(run({"plan", "scene.toml"}), 2,
                 {"300 000 triangles; try a larger one", "the body measures 0.0693 m across: is body.units right?"});
}

class GoodSurface : public PalpateProgram {};

TEST_F(GoodSurface, IsReported) {
  write("a.off", kBox);
  write("scene.toml", "body = {surface = \"a.off\"}\n");
  const RunResult result = run({"mesh", "scene.toml", "--out", "out", "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_NE(result.out.find("\"action\": \"used as it is\""), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("body.units"), std::string::npos) << result.out;
  EXPECT_TRUE(std::filesystem::exists(folder() / "out" / "body.ply"));
}

TEST_F(GoodSurface, OfAnUnlikelySizeIsToldWithItsExtents) {
  write("a.off", kBox);
  write("scene.toml", "[body]\nsurface = \"a.off\"\nunits = \"mm\"\n");  // it is in m
  const RunResult result = run({"mesh", "scene.toml"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_NE(result.out.find("the body measures 6.93e-05 m across: is body.units right?"), std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("extents 0.04 x 0.04 x 0.04 mm"), std::string::npos) << result.out;
}

TEST_F(GoodSurface, ARegionThatWasMendedIsReported) {
  write("a.off", kBox);
  write("b.off", replaced(kOpenBox, "8 10 0", "8 12 0") + "3 4 6 5\n3 4 6 7\n");  // one triangle turned
  write("scene.toml", "[body]\nsurface = \"a.off\"\n[[region]]\nname = \"lump\"\nsurface = \"b.off\"\n");
  const RunResult result = run({"mesh", "scene.toml"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_NE(result.out.find("region 'lump': surface repaired"), std::string::npos) << result.out;
}

TEST_F(GoodSurface, ARegionMayBeCalledBody) {
  write("a.off", kBox);
  write("b.off",
        "OFF\n4 4 0\n0.01 0.01 0.01\n0.03 0.01 0.01\n0.01 0.03 0.01\n0.01 0.01 0.03\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 "
        "3\n");
  write("scene.toml", "[body]\nsurface = \"a.off\"\n[[region]]\nname = \"body\"\nsurface = \"b.off\"\n");
  const RunResult result = run({"mesh", "scene.toml", "--out", "out"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  // Neither overwrites the other.
  const auto size = [&](const char* name) { return std::filesystem::file_size(folder() / "out" / name); };
  EXPECT_GT(size("body.ply"), size("region-body.ply"));
}

class ControlBytes : public PalpateProgram {};

TEST_F(ControlBytes, OfAFileArePrintedAsNumbers) {
  write("bad.nrrd", std::string("NRRD0004\nab\0\x1b[31mcd\n\n", 22));
  expect_failure(run({"scene", "--from", "bad.nrrd"}), 2, {"'ab\\x00\\x1B[31mcd' is not a field"});
  write("bad.off", "OFF\n\x1b]0;x\a 0 0\n");
  const RunResult surface = run({"scene", "--from", "bad.off"});
  expect_failure(surface, 2, {"bad.off"});
  EXPECT_EQ(surface.error.find_first_of("\x1b\a"), std::string::npos) << surface.error;
}

}  // namespace
}  // namespace palpate::test::surface_input_test
