// SPDX-License-Identifier: GPL-3.0-or-later
// Validation finds each fault, counts it right, and finds nothing in clean surfaces.
#include "precompute/surface/repair/examine.hpp"

#include "precompute/surface/repair/weld.hpp"
#include "tests/surface/faulty_shapes.hpp"

#include <limits>

namespace palpate::test {
namespace {

TEST(Examine, CleanSurfaces) {
  for (const auto& s : {cube(), sphere_surface({1, 2, 3}, 0.1), bowl(0.01), bent_rod()}) {
    const auto faults = surface::examine(s);
    EXPECT_TRUE(faults.clean()) << surface::joined(faults.lines());
    EXPECT_TRUE(faults.lines().empty()) << surface::joined(faults.lines());
  }
  EXPECT_NEAR(surface::examine(cube()).volume, 0.008, 1e-15);
}

TEST(Examine, CountsOfEachFault) {
  EXPECT_EQ(geometry::topology(small_hole()).boundary_edges, 3U);
  EXPECT_EQ(geometry::topology(small_hole()).boundary_loops, 1U);
  EXPECT_EQ(geometry::topology(fin()).nonmanifold_edges, 1U);
  EXPECT_EQ(geometry::topology(fin()).boundary_edges, 2U);
  EXPECT_EQ(geometry::topology(doubled_face()).duplicates, 2U);
  EXPECT_EQ(geometry::topology(with_degenerate()).degenerate, 1U);
  EXPECT_EQ(geometry::topology(touching_in_a_point()).nonmanifold_vertices, 1U);
  EXPECT_EQ(geometry::topology(touching_in_a_point()).components, 2U);
  EXPECT_EQ(geometry::topology(cube_and_lid(0).first).boundary_edges, 16U);
  EXPECT_GT(geometry::topology(some_flipped()).flipped_edges, 20U);
  EXPECT_EQ(geometry::topology(inside_out()).flipped_edges, 0U);
  EXPECT_NEAR(surface::examine(inside_out()).volume, -0.008, 1e-15);
  for (const auto& s : {small_hole(), fin(), doubled_face(), with_degenerate(), touching_in_a_point(), some_flipped(),
                        inside_out(), pierced(), overlapping(), split_vertices(cube())}) {
    EXPECT_FALSE(surface::examine(s).clean());
    EXPECT_FALSE(surface::examine(s).lines().empty());
  }
}

TEST(Examine, EqualPointsAreMergedBeforeCrossingsAreCounted) {
  EXPECT_GT(surface::examine(pierced()).crossings, 5U);
  EXPECT_EQ(surface::examine(split_vertices(cube())).crossings, 0U);
}

TEST(Examine, UnusableInput) {
  const auto refuse = [](const Surface& s, const std::vector<std::string>& pieces) {
    expect_error([&] { surface::require_usable(s, "organ.ply"); }, ExitCode::bad_input, pieces);
  };
  refuse(Surface{}, {"organ.ply", "no triangles"});
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Surface s = cube();
    s.vertices[17].z() = bad;
    refuse(s, {"organ.ply", "vertex 17"});
  }
  for (const std::int32_t bad : {-1, 98, 1000000}) {
    Surface s = cube();
    s.triangles[3][2] = bad;
    refuse(s, {"organ.ply", "triangle 3", std::to_string(bad), "0..97"});
  }
  Surface point = cube();
  for (auto& v : point.vertices) v = {1, 1, 1};
  refuse(point, {"organ.ply", "one place"});
}

TEST(Weld, MergesWithinTheToleranceOnly) {
  Surface s = split_vertices(cube());
  EXPECT_EQ(surface::weld(s, 0.0).vertices.size(), 98U);
  for (std::size_t v = 0; v < s.vertices.size(); ++v) s.vertices[v].x() += 1e-8 * double(v % 7);
  EXPECT_GT(surface::weld(s, 0.0).vertices.size(), 300U);
  const Surface merged = surface::weld(s, 1e-6);
  EXPECT_EQ(merged.vertices.size(), 98U);
  EXPECT_EQ(merged.triangles.size(), s.triangles.size());
  EXPECT_EQ(surface::weld(cube(), 1e-6).triangles, cube().triangles) << "numbering is kept where nothing merges";
}

}  // namespace
}  // namespace palpate::test
