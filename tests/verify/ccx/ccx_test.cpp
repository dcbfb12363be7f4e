// SPDX-License-Identifier: GPL-3.0-or-later
// The comparison with CalculiX: its deck, its answers, how it fails, and one short run of the real program.
#include "precompute/verify/ccx/ccx_compare.hpp"

#include "formats/io/error.hpp"
#include "precompute/verify/ccx/ccx_dat.hpp"
#include "tests/support/block_mesh.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <sstream>

namespace palpate::verify {
namespace {

using Eigen::Vector3d;

tool::Tool tip(ToolScene::Shape shape) {
  ToolScene scene;
  scene.shape = shape;
  scene.radius = 0.005;
  scene.edge_radius = shape == ToolScene::Shape::punch ? 0.001 : 0.0;
  return tool::make_tool(scene);
}

TEST(CcxTool, FacetsLieOnTheToolAndFaceOutward) {
  for (const auto shape : {ToolScene::Shape::sphere, ToolScene::Shape::punch}) {
    const tool::Tool tool = tip(shape);
    const ToolFacets facets = tool_facets(tool, 0.001);
    for (const Vector3d& node : facets.nodes) EXPECT_LT(std::abs(tool.shape->distance(node).value), 1e-9);
    std::map<std::pair<int, int>, int> edges;
    double area = 0;
    for (const auto& f : facets.faces) {
      const Vector3d a = facets.nodes[f[0]], b = facets.nodes[f[1]], c = facets.nodes[f[2]];
      const Vector3d normal = (b - a).cross(c - a);
      area += 0.5 * normal.norm();
      EXPECT_GT(normal.dot(tool.shape->distance((a + b + c) / 3).gradient), 0.9 * normal.norm());
      EXPECT_LT(normal.dot(facets.inside - a), 0);
      for (int k = 0; k < 3; ++k) {
        ++edges[{f[k], f[(k + 1) % 3]}];
        EXPECT_LT((facets.nodes[f[3 + k]] - (facets.nodes[f[k]] + facets.nodes[f[(k + 1) % 3]]) / 2).norm(), 2e-4);
      }
    }
    for (const auto& [edge, count] : edges) EXPECT_EQ(count, 1);
    if (shape == ToolScene::Shape::sphere) {
      const double cap = 2 * std::numbers::pi * 0.005 * 0.005 * (1 - std::cos(75 * std::numbers::pi / 180));
      EXPECT_NEAR(area / cap, 1.0, 0.03);
    }
  }
  EXPECT_THROW(tool_facets(tip(ToolScene::Shape::capsule), 0.001), std::invalid_argument);
}

// Lines of the block that begins with `keyword`, up to the next keyword.
std::vector<std::string> block(const std::string& deck, const std::string& keyword) {
  std::vector<std::string> lines;
  std::istringstream in(deck);
  bool inside = false;
  for (std::string line; std::getline(in, line);) {
    if (line[0] == '*') {
      if (inside) break;
      inside = line == keyword;
    } else if (inside) {
      lines.push_back(line);
    }
  }
  return lines;
}

std::vector<double> numbers(const std::string& line) {
  std::vector<double> all;
  std::istringstream in(line);
  for (std::string word; std::getline(in, word, ',');) all.push_back(std::stod(word));
  return all;
}

struct SmallPush {
  mesh::TetMesh mesh = test::block_mesh({-0.01, 0, 0.01}, {-0.01, 0, 0.01}, {-0.01, 0});
  std::vector<char> held;
  ToolFacets facets = tool_facets(tip(ToolScene::Shape::sphere), 0.002);
  SmallPush() {
    for (const Vector3d& p : mesh.nodes) held.push_back(p.z() < -0.0099 ? 7 : 0);
  }
  [[nodiscard]] std::string deck(double reach = 0.005) const {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = Vector3d(0, 0, 0.005);
    return ccx_deck({mesh, held, {700, 300, 2e4}, facets, pose, ContactFrame{}, {0.001, 0.002}, {5e6, 4, reach}});
  }
};

TEST(CcxDeck, HasTheMeshTheToolAndTheLawInItsUnits) {
  const SmallPush push;
  const std::string deck = push.deck();
  std::vector<Vector3d> nodes{Vector3d::Zero()};
  for (const char* keyword : {"*NODE", "*NODE,NSET=TOOL"}) {
    for (const std::string& line : block(deck, keyword)) {
      const auto v = numbers(line);
      ASSERT_EQ(v.size(), 4U);
      EXPECT_EQ(v[0], double(nodes.size()));  // numbered without a gap
      nodes.emplace_back(v[1], v[2], v[3]);
    }
  }
  EXPECT_EQ(block(deck, "*NODE").size(), push.mesh.nodes.size());
  EXPECT_NEAR((nodes[1] - 1e3 * push.mesh.nodes[0]).norm(), 0, 1e-9);
  std::vector<std::vector<double>> elements;
  for (const char* keyword : {"*ELEMENT,TYPE=C3D10,ELSET=BODY", "*ELEMENT,TYPE=C3D10,ELSET=TIP"}) {
    for (const std::string& line : block(deck, keyword)) {
      const auto v = numbers(line);
      ASSERT_EQ(v.size(), 11U);
      elements.push_back(v);
      const auto at = [&](int k) { return nodes.at(std::size_t(v[1 + k])); };
      Eigen::Matrix3d sides;
      for (int k = 0; k < 3; ++k) sides.col(k) = at(k + 1) - at(0);
      EXPECT_GT(sides.determinant(), 0);
      constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
      for (int k = 0; k < 6; ++k) {
        const Vector3d a = at(kEdges[k][0]), b = at(kEdges[k][1]);
        EXPECT_LT((at(4 + k) - (a + b) / 2).norm(), 0.1 * (a - b).norm()) << line;
      }
    }
  }
  // 3 of the 9 corners of the top lie off the diagonals that meet in the middle; all faces touch the middle or its
  // neighbours within reach.
  const auto skin = block(deck, "*SURFACE,NAME=SKIN,TYPE=ELEMENT");
  std::size_t near = 0;
  for (const auto& face : push.mesh.faces) {
    bool touches = false;
    for (int k = 0; k < 3; ++k) touches |= push.mesh.nodes[face[k]].norm() <= 0.005;
    near += touches;
  }
  EXPECT_GT(near, 0U);
  EXPECT_EQ(skin.size(), near);
  constexpr int kFaces[4][3] = {{1, 2, 3}, {1, 4, 2}, {2, 4, 3}, {3, 4, 1}};  // CalculiX' S1 to S4
  for (const std::string& line : skin) {
    const auto& element = elements.at(std::stoul(line) - 1);
    const int face = line.back() - '1';
    for (const int corner : kFaces[face]) EXPECT_EQ(nodes.at(std::size_t(element[corner])).z(), 0.0) << line;
  }
  EXPECT_EQ(block(deck, "*SURFACE,NAME=FACETS,TYPE=ELEMENT"), std::vector<std::string>{"TIP,S1"});
  EXPECT_EQ(numbers(block(deck, "*HYPERELASTIC,MOONEY-RIVLIN").at(0)), (std::vector<double>{0.7, 0.3, 0.1}));
  EXPECT_EQ(block(deck, "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR"), std::vector<std::string>{"5"});  // kPa/mm
  const auto held = block(deck, "*NSET,NSET=HELD");
  EXPECT_EQ(held.size(), 25U);  // 5 x 5 nodes of the bottom
  EXPECT_EQ(block(deck, "*NSET,NSET=HELD2"), held);
  EXPECT_EQ(block(deck, "*STATIC").at(0), "0.25,1.,1e-4,0.25");
  EXPECT_NE(deck.find("*BOUNDARY\nTOOL,1,1,-0\nTOOL,2,2,-0\nTOOL,3,3,-2\n"), std::string::npos);
  EXPECT_THROW((void)push.deck(-1), std::invalid_argument);
}

// As ccx 2.20 wrote it.
const char* const kDat = R"(
                        S T E P       1


 total force (fx,fy,fz) for set TOOL and time  0.1000000E+01

       -1.574499E-03 -2.352662E-03 -2.271460E+00

 total force (fx,fy,fz) for set HELD and time  0.1000000E+01

        1.574499E-03  2.352661E-03  2.271460E+00
)";

TEST(CcxDat, TotalsAreRead) {
  const auto totals = read_ccx_totals(kDat);
  ASSERT_EQ(totals.size(), 2U);
  EXPECT_EQ(totals[0].set, "TOOL");
  EXPECT_EQ(totals[1].set, "HELD");
  EXPECT_EQ(totals[1].time, 1.0);
  EXPECT_EQ(totals[0].force, Vector3d(-1.574499e-3, -2.352662e-3, -2.27146));
  EXPECT_TRUE(read_ccx_totals("").empty());
}

TEST(CcxDat, WhatIsNoNumberIsRefused) {
  const std::string whole = kDat;
  for (const char* bad : {"NaN", "*************", "Infinity", "2.27146+100"}) {
    std::string text = whole;
    text.replace(text.find("-2.271460E+00"), 13, bad);
    EXPECT_THROW(read_ccx_totals(text), Error) << bad;
  }
  EXPECT_THROW(read_ccx_totals(whole.substr(0, whole.rfind("2.352661E-03"))), Error);
  EXPECT_THROW(read_ccx_totals(whole.substr(0, whole.rfind("        1.5"))), Error);
}

// A program in the place of ccx.
std::filesystem::path script(const test::TemporaryFolder& folder, const std::string& lines) {
  const auto file = folder.write("ccx", "#!/bin/sh\n" + lines + "\n");
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  return file;
}

TEST(CcxRun, ForcesOfABalancedAnswerAreTaken) {
  const test::TemporaryFolder folder;
  const auto ccx = script(folder, std::string("[ \"$1 $2\" = '-i push' ] && [ \"$OMP_NUM_THREADS\" = 1 ] || exit 3\n"
                                              "grep -q deck push.inp || exit 4\n"
                                              "echo ' 1 1 1 13 1. 1. 1.' > push.sta\ncat > push.dat <<END") +
                                      kDat + "END");
  const CcxResult r = run_ccx(ccx, "a deck", 1);
  EXPECT_TRUE(r.usable) << r.cause;
  ASSERT_EQ(r.forces.size(), 1U);
  EXPECT_NEAR(r.forces[0].z(), 2.27146e-3, 1e-12);
  EXPECT_EQ(r.iterations, 13);
}

TEST(CcxRun, FailuresNameTheirCause) {
  const test::TemporaryFolder folder;
  const std::string dat = std::string("cat > push.dat <<END") + kDat + "END\n";
  std::string unbalanced = dat;
  unbalanced.replace(unbalanced.find(" 2.271460E+00"), 13, " 2.200000E+00");
  const std::pair<std::string, const char*> cases[] = {
      {"echo ' *ERROR: solution seems to diverge; please try'\necho '        automatic incrementation'\nexit 201",
       "exit status 201: *ERROR: solution seems to diverge; please try automatic incrementation"},
      {"kill -9 $$", "ended by signal 9"},
      {"while :; do :; done", "time limit reached"},
      {"exit 0", "no forces after step 1"},
      {dat, "no forces after step 2"},
      {"echo ' *ERROR in allocation'\nexit 0", "*ERROR in allocation"},
      {unbalanced, "do not balance after step 1: off by 3."},
      {"echo ' total force (fx,fy,fz) for set TOOL and time NaN' > push.dat", "unexpected line"}};
  for (const auto& [lines, cause] : cases) {
    CcxLimits limits;
    limits.cpu_time = 1;
    const CcxResult r = run_ccx(script(folder, lines), "deck", 2, limits);
    EXPECT_FALSE(r.usable);
    EXPECT_TRUE(r.forces.empty());
    EXPECT_EQ(r.cause.find("CalculiX: "), 0U) << r.cause;
    EXPECT_NE(r.cause.find(cause), std::string::npos) << r.cause;
  }
  EXPECT_THROW(run_ccx(folder.path() / "none", "deck", 1), Error);
}

TEST(CcxRun, IsLookedForInPath) {
  const test::TemporaryFolder folder;
  const std::string before = std::getenv("PATH");
  ::setenv("PATH", ("/nowhere:" + folder.path().string()).c_str(), 1);
  EXPECT_TRUE(find_ccx().empty());
  const auto ccx = script(folder, "exit 0");
  EXPECT_EQ(find_ccx(), ccx);
  std::filesystem::permissions(ccx, std::filesystem::perms::owner_read);
  if (::geteuid() != 0) {
    EXPECT_TRUE(find_ccx().empty());
  }
  ::setenv("PATH", before.c_str(), 1);
}

// Coarse and two depths; all cases: palpate verify --compare ccx.
TEST(Ccx, ForcesAgreeOnTheSameMesh) {
  const auto ccx = find_ccx();
  if (ccx.empty()) GTEST_SKIP() << "no ccx in PATH (Debian package calculix-ccx)";
  const CcxSettings settings;
  const std::vector<CcxCase> cases = ccx_cases(2);
  const CcxCase& c = cases.at(3);
  ASSERT_EQ(c.name, "sphere, Mooney-Rivlin, nu 0.45");
  const CcxMesh mesh = ccx_mesh(c, std::numbers::sqrt2, settings);
  const CcxSolve ours = solve_ours(c, mesh, true, settings), theirs = solve_ccx(ccx, c, mesh, settings);
  ASSERT_EQ(ours.forces.size(), 2U) << ours.cause;
  ASSERT_EQ(theirs.forces.size(), 2U) << theirs.cause;
  EXPECT_LT(largest_difference(ours, theirs), 0.01);
  EXPECT_GT(theirs.seconds, ours.seconds);
  // The default element is another discretisation: were the plain one not used, this would be nearly zero.
  EXPECT_GT(largest_difference(solve_ours(c, mesh, false, settings), ours), 0.02);
  // A quarter of the body is meshed differently, and pressed alike.
  const CcxSolve quarter = solve_ccx(ccx, c, ccx_mesh(c, std::numbers::sqrt2, settings, true), settings);
  ASSERT_EQ(quarter.forces.size(), 2U) << quarter.cause;
  EXPECT_LT(largest_difference(quarter, theirs), 0.05);
}

}  // namespace
}  // namespace palpate::verify
