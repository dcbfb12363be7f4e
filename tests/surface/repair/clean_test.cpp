// SPDX-License-Identifier: GPL-3.0-or-later
// The ladder: as it is, repaired, wrapped; what comes out is always a clean surface near the input.
#include "precompute/surface/repair/clean.hpp"

#include "precompute/surface/repair/examine.hpp"
#include "precompute/surface/repair/weld.hpp"
#include "tests/surface/faulty_shapes.hpp"

#include <cmath>
#include <random>
#include <set>

namespace palpate::test {
namespace {

std::set<std::string> parts_of(const Surface& s) {
  std::set<std::string> names;
  for (const auto p : s.parts) names.insert(s.part_names.at(std::size_t(p)));
  return names;
}

struct Expected {
  std::string name;
  Surface input;
  std::string action;
  double volume;            ///< m^3
  double volume_tolerance;  ///< relative
  double move;              ///< m, at most
};

TEST(Clean, EveryKindOfInput) {
  const auto [box, lid] = cube_and_lid(0);
  const auto [box_apart, lid_apart] = cube_and_lid(3e-4);
  const double tiny = 1e-12;
  const std::vector<Expected> all = {
      {"clean", cube(), "used as it is", 0.008, 1e-12, 0},
      {"ball", sphere_surface({0, 0, 0}, 0.1), "used as it is", 4.0 / 3 * std::numbers::pi * 1e-3, 0.02, 0},
      {"split", split_vertices(cube()), "repaired", 0.008, 1e-12, tiny},
      {"hole", small_hole(), "repaired", 0.008, 1e-12, 0.02},
      {"fin", fin(), "repaired", 0.008, 1e-12, tiny},
      {"doubled", doubled_face(), "repaired", 0.008, 1e-12, tiny},
      {"flipped", some_flipped(), "repaired", 0.008, 1e-12, tiny},
      {"inside out", inside_out(), "repaired", 0.008, 1e-12, tiny},
      {"degenerate", with_degenerate(), "repaired", 0.008, 1e-9, 1e-9},
      {"joined", together(box, lid), "repaired", 0.008, 1e-12, tiny},
      {"joined apart", together(box_apart, lid_apart), "repaired", 0.008, 0.01, 4e-4},
      {"pierced", pierced(), "wrapped", 0.0081, 0.2, 0.03},
      {"overlapping", overlapping(), "wrapped", 0.015, 0.06, 0.01},
  };
  for (const auto& e : all) {
    SCOPED_TRACE(e.name);
    const auto cleaned = surface::clean_surface(e.input, {}, "organ.ply");
    const auto& report = cleaned.report;
    const auto& surface = cleaned.query->surface();
    EXPECT_EQ(report.action, e.action) << surface::joined(report.findings);
    EXPECT_TRUE(surface::examine(surface).clean());
    EXPECT_TRUE(closed_and_oriented(surface));
    EXPECT_NEAR(surface_volume(surface), e.volume, e.volume * e.volume_tolerance);
    EXPECT_NEAR(report.volume, surface_volume(surface), 1e-12);
    EXPECT_LE(report.largest_move, e.move);
    EXPECT_LE(report.mean_move, report.largest_move);
    EXPECT_EQ(report.vertices, surface.vertices.size());
    EXPECT_EQ(report.triangles, surface.triangles.size());
    EXPECT_EQ(report.findings.empty(), e.action == "used as it is");
    EXPECT_EQ(parts_of(surface).size(), parts_of(e.input).size()) << "a part was lost";
  }
}

TEST(Clean, PartsStayWhereTheyWere) {
  const auto [box, lid] = cube_and_lid(0);
  for (const auto mode : {RepairMode::repair, RepairMode::wrap}) {
    const auto cleaned = surface::clean_surface(together(box, lid), {mode, 0, 0}, "organ.ply");
    const auto& s = cleaned.query->surface();
    double lid_area = 0;
    for (std::size_t t = 0; t < s.triangles.size(); ++t) {
      if (s.part_names[std::size_t(s.parts[t])] != "lid") continue;
      lid_area += geometry::triangle_normal(s, t).norm() / 2;
      EXPECT_GT(s.vertices[std::size_t(s.triangles[t][0])].z(), 0.18);
    }
    EXPECT_NEAR(lid_area, 0.04, mode == RepairMode::repair ? 1e-12 : 0.006);
  }
}

TEST(Clean, SmallHolesAndFlatRimsAreClosed) {
  const auto cleaned = surface::clean_surface(small_hole(), {RepairMode::repair, 0, 0}, "organ.ply");
  EXPECT_NEAR(cleaned.report.volume, 0.008, 1e-15);
  EXPECT_NEAR(cleaned.report.area, 0.24, 1e-15);
  const auto capped = surface::clean_surface(cube_and_lid(0).first, {RepairMode::repair, 0, 0}, "organ.ply");
  EXPECT_NEAR(capped.report.volume, 0.008, 1e-12);
  ASSERT_EQ(capped.report.findings.size(), 2U);
  EXPECT_NE(capped.report.findings[1].find("closed a flat rim of 16 edges"), std::string::npos);
}

// A thick wall cut by a plane has two rims in it: the cap is a ring.
TEST(Clean, ARimInsideAnotherIsAHoleInTheCap) {
  Surface both = together(sphere_surface({0, 0, 0}, 0.1), sphere_surface({0, 0, 0}, 0.06));
  const std::size_t half = both.triangles.size() / 2;
  std::vector<bool> keep(both.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) {
    auto& c = both.triangles[t];
    if (t >= half) std::swap(c[1], c[2]);
    double highest = -1;
    for (const auto v : c) highest = std::max(highest, both.vertices[std::size_t(v)].z());
    keep[t] = highest < 1e-9;
  }
  const Surface open = surface::keep_triangles(both, keep);
  ASSERT_GT(geometry::topology(open).boundary_edges, 0U);
  const auto cleaned = surface::clean_surface(open, {}, "organ.ply");
  EXPECT_EQ(cleaned.report.action, "repaired") << cleaned.report.findings.size();
  EXPECT_NEAR(cleaned.report.volume, 2.0 / 3 * std::numbers::pi * (1e-3 - 2.16e-4), 0.12e-3);  // its facets are coarse
}

// A rim that no plane fits: a wrap would be a bag, and the message says what to do.
TEST(Clean, AnOpenSurfaceWithABentRimIsNoBag) {
  const Surface ball = sphere_surface({0, 0, 0}, 0.1);
  std::vector<bool> keep(ball.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto v : ball.triangles[t]) middle += ball.vertices[std::size_t(v)] / 3;
    keep[t] = middle.z() < 0.03 + 0.04 * std::cos(2 * std::atan2(middle.y(), middle.x()));
  }
  expect_error([&] { surface::clean_surface(surface::keep_triangles(ball, keep), {}, "organ.ply"); },
               ExitCode::bad_input,
               {"organ.ply", "boundary edges in 1 loops", "no rim is flat enough", "Close its holes"});
}

// Two blocks share an edge; the shared edge comes apart, and nothing else moves.
TEST(Clean, BlocksThatTouchInAnEdgeAreSplit) {
  const Surface blocks = together(box_surface({0, 0, 0}, {1, 1, 1}), box_surface({1, 1, 0}, {2, 2, 1}));
  const auto cleaned = surface::clean_surface(surface::weld(blocks, 1e-9), {}, "organ.ply");
  EXPECT_EQ(cleaned.report.action, "repaired");
  EXPECT_NEAR(cleaned.report.volume, 2, 0.02);
  EXPECT_EQ(cleaned.report.findings[1].find("split where blocks touch in 1 edges"), 0U) << cleaned.report.findings[1];
  const Surface small = together(box_surface({0, 0, 0}, {1, 1, 1}), box_surface({1, 1, 0}, {1.2, 1.2, 1}));
  const auto alone = surface::clean_surface(surface::weld(small, 1e-9), {}, "organ.ply");
  EXPECT_NEAR(alone.report.volume, 1, 0.01);
}

TEST(Clean, ModeNoneNamesTheFault) {
  const auto refuse = [](const Surface& s, const std::string& piece) {
    expect_error(
        [&] {
          surface::clean_surface(s, {RepairMode::none, 0, 0}, "organ.ply");
        },
        ExitCode::bad_input, {"organ.ply", "none", piece});
  };
  EXPECT_EQ(surface::clean_surface(cube(), {RepairMode::none, 0, 0}, "organ.ply").report.action, "used as it is");
  refuse(small_hole(), "3 boundary edges in 1 loop");
  refuse(fin(), "more than two triangles");
  refuse(doubled_face(), "double another");
  refuse(some_flipped(), "opposite ways");
  refuse(inside_out(), "inside out");
  refuse(pierced(), "self-intersecting");
  refuse(overlapping(), "self-intersecting");
  refuse(with_degenerate(), "without area");
  refuse(touching_in_a_point(), "touch in a point");
}

TEST(Clean, RepairAloneGivesUpWithTheReason) {
  for (const auto& s : {pierced(), overlapping()}) {
    expect_error(
        [&] {
          surface::clean_surface(s, {RepairMode::repair, 0, 0}, "organ.ply");
        },
        ExitCode::bad_input, {"organ.ply", "after repair", "wrap"});
  }
}

TEST(Clean, FlatAndUnusableInputIsRefused) {
  Surface flat = cube();
  for (auto& v : flat.vertices) v.z() = 0;
  for (const auto mode : {RepairMode::none, RepairMode::repair}) {
    expect_error([&] { surface::clean_surface(flat, {mode, 0, 0}, "organ.ply"); }, ExitCode::bad_input, {"organ.ply"});
  }
  Surface line = cube();
  for (auto& v : line.vertices) v = Eigen::Vector3d(v.x() + v.y() + v.z(), 0, 0);
  for (const auto mode : {RepairMode::automatic, RepairMode::none, RepairMode::repair, RepairMode::wrap}) {
    expect_error([&] { surface::clean_surface(line, {mode, 0, 0}, "organ.ply"); }, ExitCode::bad_input, {"organ.ply"});
  }
  expect_error([] { surface::clean_surface(Surface{}, {}, "organ.ply"); }, ExitCode::bad_input,
               {"organ.ply", "no triangles"});
}

TEST(Clean, SeparateComponents) {
  // Apart: kept, with a note. A cavity faces inward; a solid inside another is refused.
  const auto apart = surface::clean_surface(together(cube(), sphere_surface({0.5, 0.1, 0.1}, 0.05)), {}, "organ.ply");
  EXPECT_EQ(apart.report.action, "used as it is");
  EXPECT_EQ(apart.report.findings, std::vector<std::string>{"2 separate components"});
  const Surface ball = sphere_surface({0.1, 0.1, 0.1}, 0.05);
  Surface wall = ball;
  for (auto& t : wall.triangles) std::swap(t[1], t[2]);
  const auto hollow = surface::clean_surface(together(cube(), wall), {}, "organ.ply");
  EXPECT_EQ(hollow.report.action, "used as it is");
  EXPECT_NEAR(hollow.report.volume, 0.008 - surface_volume(sphere_surface({0, 0, 0}, 0.05)), 1e-12);
  for (const auto mode : {RepairMode::automatic, RepairMode::none, RepairMode::repair}) {
    expect_error(
        [&] {
          surface::clean_surface(together(cube(), ball), {mode, 0, 0}, "organ.ply");
        },
        ExitCode::bad_input, {"organ.ply", "component 2 of 2", "faces outward", "[[region]]", "[[cavity]]"});
  }
}

TEST(Clean, WrapTakesInnerMeshesIn) {
  // An open double-walled bag alone is a thin shell; with something in it that fills it, a solid.
  const auto bag = bowl(0.002);
  const auto alone = surface::clean_surface(bag, {RepairMode::wrap, 0, 0}, "organ.ply");
  EXPECT_TRUE(alone.report.thin_bag);
  const auto filled =
      surface::clean_surface(together(bag, named(sphere_surface({0, 0, 0}, 0.097), "inner")), {}, "organ.ply");
  EXPECT_FALSE(filled.report.thin_bag);
  EXPECT_EQ(filled.report.action, "used as it is") << "nested without contact: two components";
  const auto wrapped = surface::clean_surface(together(bag, named(sphere_surface({0, 0, 0}, 0.097), "inner")),
                                              {RepairMode::wrap, 0, 0}, "organ.ply");
  EXPECT_FALSE(wrapped.report.thin_bag);
  EXPECT_NEAR(wrapped.report.volume, 4.0 / 3 * std::numbers::pi * 1e-3, 3e-4);
}

// Any triangles have an answer: a clean surface, or a refusal that names the input.
TEST(Clean, RandomSoups) {
  std::mt19937 random(3);
  const auto number = [&](std::size_t below) { return std::int32_t(random() % below); };
  int cleaned = 0, refused = 0;
  for (int round = 0; round < 50; ++round) {
    Surface s;
    const auto vertices = std::size_t(4 + number(12));
    for (std::size_t v = 0; v < vertices; ++v) s.vertices.emplace_back(number(4), number(4), number(4));
    for (std::size_t t = 0, count = 4 + std::size_t(number(30)); t < count; ++t) {
      s.triangles.push_back({number(vertices), number(vertices), number(vertices)});
    }
    set_one_part(s, "soup");
    try {
      const auto result = surface::clean_surface(s, {RepairMode::automatic, 1.0, 0.1}, "soup");
      EXPECT_TRUE(surface::examine(result.query->surface()).clean());
      EXPECT_TRUE(std::isfinite(result.report.largest_move) && std::isfinite(result.report.thickness_median));
      ++cleaned;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input);
      EXPECT_EQ(std::string(error.what()).rfind("soup: ", 0), 0U) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(cleaned, 30);
  EXPECT_EQ(cleaned + refused, 50);
}

// The facets of a coarse ball go, its vertices and its labels stay.
TEST(Clean, SmoothingRoundsABallOff) {
  Surface ball = sphere_surface({0, 0, 0}, 0.01, 2);
  ball.part_names = {"south", "north"};
  for (std::size_t t = 0; t < ball.triangles.size(); ++t) {
    const auto& c = ball.triangles[t];
    ball.parts[t] = ball.vertices[c[0]].z() + ball.vertices[c[1]].z() + ball.vertices[c[2]].z() > 0 ? 1 : 0;
  }
  surface::CleanOptions options;
  options.smooth = 2;
  const auto result = surface::clean_surface(ball, options, "ball");
  const Surface& smooth = result.query->surface();
  EXPECT_EQ(result.report.action, "used as it is, smoothed");
  EXPECT_EQ(smooth.triangles.size(), 16 * ball.triangles.size());
  for (const auto& v : ball.vertices) EXPECT_LT(result.query->closest(v).distance, 1e-12);
  const auto deepest = [](const Surface& s) {
    double least = 1;
    for (const auto& t : s.triangles) {
      least = std::min(least, (s.vertices[t[0]] + s.vertices[t[1]] + s.vertices[t[2]]).norm() / 3);
    }
    return 0.01 - least;
  };
  EXPECT_LT(deepest(smooth), deepest(ball) / 3);
  for (std::size_t t = 0; t < smooth.triangles.size(); ++t) {
    const auto& c = smooth.triangles[t];
    const double z = (smooth.vertices[c[0]].z() + smooth.vertices[c[1]].z() + smooth.vertices[c[2]].z()) / 3;
    if (std::abs(z) < 2e-3) continue;  // a triangle that straddled the border
    EXPECT_EQ(smooth.part_names[smooth.parts[t]], z > 0 ? "north" : "south");
  }
}

TEST(Clean, SmoothingKeepsEdgesStraightWhereTheSurfaceWouldCrossItself) {
  // Two sheets 0.2 mm apart, one of them dented: what is rounded overshoots into the other.
  Surface thin = box_surface({0, 0, 0}, {0.04, 0.04, 0.0002}, 4);
  for (auto& v : thin.vertices) {
    if (v.z() > 1e-4 && std::abs(v.x() - 0.02) < 1e-9 && std::abs(v.y() - 0.02) < 1e-9) v.z() = 0.02;
  }
  surface::CleanOptions options;
  options.smooth = 2;
  const auto result = surface::clean_surface(thin, options, "sheet");
  const Surface& smooth = result.query->surface();
  EXPECT_TRUE(surface::examine(smooth).clean());
  EXPECT_EQ(smooth.triangles.size(), 16 * thin.triangles.size());
  ASSERT_EQ(result.report.findings.size(), 1U);
  EXPECT_NE(result.report.findings[0].find("edges kept straight"), std::string::npos);
  // The dent itself is rounded: its slopes are no longer flat between the old vertices.
  EXPECT_GT(result.report.largest_move, 1e-4);
  for (const auto& v : thin.vertices) EXPECT_LT(result.query->closest(v).distance, 1e-12);
}

TEST(Clean, SameResultEveryTime) {
  for (const auto& s : {overlapping(), fin(), with_degenerate()}) {
    const auto a = surface::clean_surface(s, {}, "organ.ply"), b = surface::clean_surface(s, {}, "organ.ply");
    EXPECT_EQ(a.query->surface().vertices, b.query->surface().vertices);
    EXPECT_EQ(a.query->surface().triangles, b.query->surface().triangles);
    EXPECT_EQ(a.query->surface().parts, b.query->surface().parts);
  }
}

}  // namespace
}  // namespace palpate::test
