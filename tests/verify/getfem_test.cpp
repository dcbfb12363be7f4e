// SPDX-License-Identifier: GPL-3.0-or-later
// The laws that scenes choose, at large strain, beside GetFEM: another element code, Newton's method and assembly
// (CalculiX has other volume terms, see ccx_compare.hpp).
#include "precompute/fem/materials/scene_material.hpp"
#include "precompute/mesh/volume/child_process.hpp"
#include "precompute/verify/ccx/ccx_compare.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <sstream>

namespace palpate::verify {
namespace {

constexpr const char* kPython = "/usr/bin/python3";  // Debian's, whose module getfem is

mesh::ChildResult python(const std::vector<std::string>& arguments) {
  mesh::ChildLimits limits;
  limits.cpu_time = 3000;
  limits.memory = 0;
  mesh::ChildStart start;
  start.arguments = arguments;
  start.environment = {"OMP_NUM_THREADS=1", "OPENBLAS_NUM_THREADS=1"};
  return mesh::run_child(kPython, {}, limits, start);
}

bool has_getfem() { return std::filesystem::exists(kPython) && python({"-c", "import getfem"}).finished; }

/// The block and tips of the comparison with CalculiX, with a law as a scene has it.
CcxCase with_law(CcxCase c, double share_of_c01) {
  MaterialScene law;
  law.young = c.body.material.young;
  law.poisson = c.body.material.poisson;
  const double mu = law.young / (2 * (1 + law.poisson));
  if (share_of_c01 > 0) {
    law.law = MaterialScene::Law::mooney_rivlin;
    law.c01 = 0.5 * mu * share_of_c01;
    law.c10 = 0.5 * mu - law.c01;
  }
  c.law.c01 = law.c01;
  c.material = fem::make_material(law);
  return c;
}

/// tests/verify/getfem_contact.py describes the format: mm and kPa.
std::string problem(const CcxCase& c, const mesh::TetMesh& mesh) {
  const ToolScene& tool = c.tool.scene;
  const double poisson = c.body.material.poisson, young = c.body.material.young;
  std::string text =
      fmt::format("law {} {} {}\n", 1e-3 * (young / (2 * (1 + poisson)) - 2 * c.law.c01), 1e-3 * c.law.c01, poisson);
  text += tool.shape == ToolScene::Shape::sphere
              ? fmt::format("sphere {}\n", 1e3 * tool.radius)
              : fmt::format("punch {} {}\n", 1e3 * tool.radius, 1e3 * tool.edge_radius);
  const double scale = 1e-3 * young / (1e3 * tool::contact_radius(c.tool.vertices.at(0), c.depths.back()));
  text += fmt::format("stiffness {} {}\n", 100 * scale, 1500 * scale);
  text += "depths";
  for (const double depth : c.depths) text += fmt::format(" {}", 1e3 * depth);
  text += fmt::format("\nnodes {}\n", mesh.corner_count);
  for (int n = 0; n < mesh.corner_count; ++n) {
    text += fmt::format("{} {} {}\n", 1e3 * mesh.nodes[n].x(), 1e3 * mesh.nodes[n].y(), 1e3 * mesh.nodes[n].z());
  }
  text += fmt::format("tets {}\n", mesh.tets.size());
  for (const auto& t : mesh.tets) text += fmt::format("{} {} {} {}\n", t[0], t[1], t[2], t[3]);
  return text;
}

/// Empty forces with the cause where GetFEM finds no equilibrium.
CcxSolve solve_getfem(const CcxCase& c, const CcxMesh& mesh) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("problem", problem(c, mesh.mesh));
  const mesh::ChildResult child = python({PALPATE_GETFEM_CONTACT, file.string()});
  CcxSolve solve;
  solve.seconds = child.cpu_time;
  solve.cause = child.cause + child.messages;
  std::istringstream lines(std::string(child.output.begin(), child.output.end()));
  for (double depth = 0, force = 0; child.finished && lines >> depth >> force;) solve.forces.push_back(1e-3 * force);
  return solve;
}

void expect_agreement(const CcxCase& c, double size, std::size_t depths, double within) {
  const CcxSettings settings;
  const CcxMesh mesh = ccx_mesh(c, size, settings);
  const CcxSolve ours = solve_ours(c, mesh, true, settings), theirs = solve_getfem(c, mesh);
  ASSERT_EQ(ours.forces.size(), depths) << c.name << ": " << ours.cause;
  ASSERT_EQ(theirs.forces.size(), depths) << c.name << ": " << theirs.cause;
  const double difference = largest_difference(ours, theirs);
  EXPECT_LT(difference, within) << c.name;
  fmt::print("{}: {} nodes, {:.2f} % apart; ours {:.1f} s, GetFEM {:.1f} s\n", c.name, ours.nodes, 100 * difference,
             ours.seconds, theirs.seconds);
}

// One law on a coarse mesh. On meshes of 300 to 450 nodes how contact is integrated over their faces matters: they are
// 0.8 to 2.8 % apart, those of more than 640 nodes 0.1 to 0.8 %.
TEST(Getfem, ForcesAgreeOnTheSameMesh) {
  if (!has_getfem()) GTEST_SKIP() << "no module getfem (Debian package python3-getfem)";
  CcxCase c = with_law(ccx_cases(2).at(3), 0.3);
  ASSERT_EQ(c.name, "sphere, Mooney-Rivlin, nu 0.45");
  expect_agreement(c, 1.6, 2, 0.01);
}

TEST(GetfemLong, ForcesOfEveryTipAndLawAgreeOnTheSameMesh) {
  if (!has_getfem()) GTEST_SKIP() << "no module getfem (Debian package python3-getfem)";
  for (const CcxCase& c : ccx_cases(4)) {
    expect_agreement(with_law(c, c.law.c01 > 0 ? 0.3 : 0), std::numbers::sqrt2, 4, 0.01);
  }
}

}  // namespace
}  // namespace palpate::verify
