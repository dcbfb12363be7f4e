// SPDX-License-Identifier: GPL-3.0-or-later
// Curves from lines and from tables of points; what is refused, by line and cause.
#include "formats/surface/curve_io.hpp"
#include "tests/surface_io/scratch.hpp"

namespace palpate::test {
namespace {

TEST(CurveFiles, ObjLinesByNameInAnyOrder) {
  const Scratch scratch;
  const auto file = scratch.write("c.obj",
                                  "# two curves\nv 0 0 0\nv 1 0 0\nv 1 2 0\nv 9 9 9\no up\nl 1 2 # first\n"
                                  "l 2 3\no down\nl 3/1 -1\nl -1 1\n");
  const Curves all = read_curves({file, {}, 0.001});
  EXPECT_EQ(all.points.size(), 4U);
  EXPECT_EQ(all.pieces.size(), 4U);
  const Curves up = read_curves({file, {"up"}, 0.001});
  ASSERT_EQ(up.points.size(), 3U);  // the point that only the other one has is left out
  EXPECT_EQ(up.points[2], Eigen::Vector3d(0.001, 0.002, 0));
  ASSERT_EQ(up.pieces.size(), 2U);
  EXPECT_EQ(up.pieces[1], (std::array<std::int32_t, 2>{1, 2}));
  EXPECT_EQ(read_curves({file, {"down"}, 1}).points[1], Eigen::Vector3d(9, 9, 9));
}

TEST(CurveFiles, TableOfPoints) {
  const Scratch scratch;
  for (const char* text :
       {"# mm\nx,y,z\n0,0,0\n1,2,3\n\n4,5,6\n", "0 0 0\r\n1 2 3\r\n4 5 6", "0; 0; 0\n1; 2; 3\n4; 5; 6 # end\n"}) {
    const Curves c = read_curves({scratch.write("c.csv", text), {}, 0.5});
    ASSERT_EQ(c.points.size(), 3U) << text;
    EXPECT_EQ(c.points[2], Eigen::Vector3d(2, 2.5, 3));
    EXPECT_EQ(c.pieces.size(), 2U);
  }
}

TEST(CurveFiles, BadOnesNameTheirCause) {
  const Scratch scratch;
  const std::string points = "v 0 0 0\nv 1 0 0\n";
  const struct {
    const char* name;
    std::string text;
    std::vector<std::string> expected;
  } bad[] = {{"a.obj", points, {"a.obj", "no curve"}},
             {"b.obj", points + "l 1 3\n", {"b.obj:3", "vertex index 3", "1..2"}},
             {"c.obj", points + "l 1\n", {"c.obj:3", "at least two points"}},
             {"d.obj", points + "l 1 x\n", {"d.obj:3", "'x' is not a whole number"}},
             {"e.obj", points + "l 1 1\n", {"e.obj:3", "no length"}},
             {"f.obj", "v 0 0\nl 1 1\n", {"f.obj:1", "a coordinate is missing"}},
             {"g.csv", "0,0,0\n0,0,nan\n", {"g.csv:2", "not finite"}},
             {"h.csv", "0,0,0\n1,1\n", {"h.csv:2", "missing"}},
             {"i.csv", "0,0,0\n1,1,1,1\n", {"i.csv:2", "three coordinates"}},
             {"j.csv", "0,0,0\n0,0,0\n", {"j.csv:2", "no length"}},
             {"k.csv", "1,2,3\n", {"k.csv:1", "at least two points"}},
             {"l.csv", "", {"l.csv", "no curve"}},
             {"m.ply", "", {"m.ply", "'.ply'", ".obj, .csv"}}};
  for (const auto& b : bad) {
    expect_error([&] { read_curves({scratch.write(b.name, b.text), {}, 1}); }, ExitCode::bad_input, b.expected);
  }
  const auto named = scratch.write("n.obj", points + "o a\nl 1 2\n");
  expect_error([&] { read_curves({named, {"b"}, 1}); }, ExitCode::bad_input, {"no lines named 'b'", "there are: a"});
  expect_error([&] { read_curves({scratch / "none.csv", {}, 1}); }, ExitCode::io, {"none.csv"});
}

}  // namespace
}  // namespace palpate::test
