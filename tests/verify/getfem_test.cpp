// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts at large strain beside GetFEM, another element code with its own assembly and Newton's method, on the same
// mesh with the same energy: every law that scenes choose, thin layers, shells, caps and inclusions (CalculiX has other
// volume terms, see ccx_compare.hpp).
#include "precompute/common/body.hpp"
#include "precompute/fem/materials/scene_material.hpp"
#include "precompute/geometry/solids.hpp"
#include "precompute/mesh/volume/child_process.hpp"
#include "precompute/mesh/volume/volume_mesh.hpp"
#include "precompute/solve/pair/contact_size.hpp"
#include "precompute/solve/pair/sample_difference.hpp"
#include "precompute/solve/push/push.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace palpate::verify {
namespace {

using Law = MaterialScene::Law;

constexpr const char* kPython = "/usr/bin/python3";  // Debian's, whose module getfem is
constexpr double kRadius = 0.005, kYoung = 5e3;      // of the tip, m; Pa

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

/// A push along -z at the origin, where the body's surface is level.
struct GetfemCase {
  std::string name;
  Scene scene;  ///< body, supports and first tool
  Surface surface;
  std::vector<double> depths;            ///< m
  double mesh_size = 0.5, growth = 0.8;  ///< see SolverScene
};

MaterialScene material(Law law, double poisson) {
  MaterialScene m;
  m.law = law;
  m.young = kYoung;
  m.poisson = poisson;
  const double mu = kYoung / (2 * (1 + poisson));
  m.c01 = 0.15 * mu, m.c10 = 0.35 * mu;
  m.c1 = 0.25 * mu, m.beta = 2.0;
  m.terms = {{0.6 * mu, 4.0}, {-0.2 * mu, -2.0}};
  m.k1 = 2 * kYoung, m.k2 = 2.0, m.dispersion = 0.1, m.fibre = {1, 0, 0};
  return m;
}

GetfemCase case_of(std::string name, const MaterialScene& material, Surface surface, double held_below, double depth,
                   int depths = 4) {
  GetfemCase c;
  c.name = std::move(name);
  c.scene.material = material;
  SupportScene bottom;
  bottom.point = {0, 0, held_below};
  c.scene.supports = {bottom};
  c.scene.tools.resize(1);
  c.scene.tools[0].radius = kRadius;
  c.surface = std::move(surface);
  for (int k = 1; k <= depths; ++k) c.depths.push_back(depth * k / depths);
  return c;
}

/// Held at its bottom.
GetfemCase block(const std::string& name, const MaterialScene& material, double thickness, double depth) {
  const double half = 4 * kRadius;
  return case_of(name, material, geometry::box_solid({-half, -half, -thickness}, {half, half, 0}, half / 2, "block"),
                 -thickness * (1 - 1e-6), depth);
}

GetfemCase punch(GetfemCase c) {
  c.scene.tools[0].shape = ToolScene::Shape::punch;
  c.scene.tools[0].edge_radius = kRadius / 5;
  c.mesh_size = 0.7;
  return c;
}

/// A ball of 20 mm, held below: whole, or with a cavity that leaves a wall.
GetfemCase ball(const std::string& name, const MaterialScene& material, double wall, double depth) {
  const double radius = 4 * kRadius;
  const auto sphere = [&](double r) {
    return geometry::ellipsoid({0, 0, -radius}, Eigen::Vector3d::Constant(r), radius / 5, "ball");
  };
  Surface surface = sphere(radius);
  if (wall > 0) {
    const auto before = static_cast<std::int32_t>(surface.vertices.size());
    const Surface inner = sphere(radius - wall);
    surface.vertices.insert(surface.vertices.end(), inner.vertices.begin(), inner.vertices.end());
    for (const auto& [a, b, c] : inner.triangles) {
      surface.triangles.push_back({before + a, before + c, before + b});
      surface.parts.push_back(0);
    }
  }
  return case_of(name, material, std::move(surface), -1.7 * radius, depth);
}

GetfemCase inclusion(const std::string& name, double contrast, double below) {
  GetfemCase c = block(name, material(Law::neo_hookean, 0.45), 4 * kRadius, 0.5 * kRadius);
  RegionScene region;
  region.name = "lump";
  region.shape = RegionScene::Shape::ellipsoid;
  region.radii = Eigen::Vector3d::Constant(0.8 * kRadius);
  region.centre = {0, 0, -below - 0.8 * kRadius};
  region.material = material(Law::neo_hookean, 0.45);
  region.material.young *= contrast;
  c.scene.regions = {region};
  return c;
}

/// The energy that `m` has, in GetFEM's language and kPa: {f} the deformation's gradient, {i1} and {i2} the invariants
/// of F'F, {j} det F.
std::string energy(const MaterialScene& m) {
  const fem::Material material = fem::make_material(m);
  const double mu = 1e-3 * m.young / (2 * (1 + m.poisson)), lambda = 2 * mu * m.poisson / (1 - 2 * m.poisson);
  std::string text = fmt::format("{}/2*({{i1}}-3)+({})*({{j}}-1)+{}/2*sqr({{j}}-1)", 1e-3 * material.mu,
                                 1e-3 * material.slope, 1e-3 * material.bulk);
  switch (m.law) {
    case Law::neo_hookean:
      break;
    case Law::mooney_rivlin:
      text += fmt::format("+{}*({{i2}}-3)", 1e-3 * m.c01);
      break;
    case Law::veronda_westmann:
      text += fmt::format("+{}*(exp({}*({{i1}}-3))-1)-{}*({{i2}}-3)", 1e-3 * m.c1, m.beta, 0.5e-3 * m.c1 * m.beta);
      break;
    case Law::ogden:  // the powers 4 and -2 of the stretches are invariants
      text += fmt::format("+{}*(Norm_sqr({{f}}'*{{f}})-3)-({})*({{i2}}/sqr({{j}})-3)", 1e-3 * m.terms[0].mu / 4,
                          1e-3 * m.terms[1].mu / 2);
      break;
    case Law::holzapfel:
      text += fmt::format(
          "+{}*(exp({}*sqr(positive[{}*({{i1}}-3)+{}*(sqr({{f}}(1,1))+sqr({{f}}(2,1))+sqr({{f}}(3,1))-1)]))-1)",
          1e-3 * m.k1 / (2 * m.k2), m.k2, m.dispersion, 1 - 3 * m.dispersion);
      break;
    case Law::st_venant:
      text += fmt::format("+{}/8*sqr({{i1}}-3)+{}/4*Norm_sqr({{f}}'*{{f}}-Id(3))", lambda, mu);
      break;
    case Law::linear:
      text += fmt::format("+{}/2*sqr(Trace({{f}})-3)+{}*Norm_sqr(Sym({{f}})-Id(3))", lambda, mu);
      break;
  }
  return text;
}

/// tests/verify/getfem_contact.py describes the format: mm and kPa.
std::string problem(const GetfemCase& c, const tool::Tool& tool, const mesh::TetMesh& mesh,
                    const std::vector<char>& held) {
  std::string text = fmt::format("energy 0 {}\n", energy(c.scene.material));
  for (std::size_t k = 0; k < c.scene.regions.size(); ++k) {
    text += fmt::format("energy {} {}\n", k + 1, energy(c.scene.regions[k].material));
  }
  const ToolScene& scene = tool.scene;
  text += scene.shape == ToolScene::Shape::sphere
              ? fmt::format("sphere {}\n", 1e3 * scene.radius)
              : fmt::format("punch {} {}\n", 1e3 * scene.radius, 1e3 * scene.edge_radius);
  const double scale = 1e-3 * kYoung / (1e3 * tool::contact_radius(tool.vertices.at(0), c.depths.back()));
  text += fmt::format("stiffness {} {} {} {}\n", 100 * scale, 300 * scale, 700 * scale, 1500 * scale);
  text += "depths";
  for (const double depth : c.depths) text += fmt::format(" {}", 1e3 * depth);
  text += fmt::format("\nnodes {}\n", mesh.corner_count);
  for (int n = 0; n < mesh.corner_count; ++n) {
    const Eigen::Vector3d& x = mesh.nodes[n];
    text += fmt::format("{} {} {}\n", 1e3 * x.x(), 1e3 * x.y(), 1e3 * x.z());
  }
  text += fmt::format("tets {}\n", mesh.tets.size());
  for (std::size_t k = 0; k < mesh.tets.size(); ++k) {
    const auto& t = mesh.tets[k];
    text += fmt::format("{} {} {} {} {}\n", t[0], t[1], t[2], t[3], mesh.regions[k]);
  }
  text += fmt::format("held {}\n", std::count(held.begin(), held.end(), char{1}));
  for (std::size_t n = 0; n < held.size(); ++n) {
    const Eigen::Vector3d& x = mesh.nodes[n];
    if (held[n] != 0) text += fmt::format("{} {} {}\n", 1e3 * x.x(), 1e3 * x.y(), 1e3 * x.z());
  }
  return text;
}

/// Empty where GetFEM finds no equilibrium.
std::vector<double> solve_getfem(const std::string& problem, double& seconds) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("problem", problem);
  const mesh::ChildResult child = python({PALPATE_GETFEM_CONTACT, file.string()});
  seconds = child.cpu_time;
  EXPECT_TRUE(child.finished) << child.cause << child.messages;
  std::vector<double> forces;
  std::istringstream lines(std::string(child.output.begin(), child.output.end()));
  for (double depth = 0, force = 0; child.finished && lines >> depth >> force;) forces.push_back(1e-3 * force);
  return forces;
}

/// The body whose surface is the mesh's: a contact with other facets than GetFEM's is another problem.
Body of_facets(Body body, const mesh::TetMesh& mesh) {
  Surface surface;
  surface.vertices.assign(mesh.nodes.begin(), mesh.nodes.begin() + mesh.corner_count);
  for (const auto& face : mesh.faces) surface.triangles.push_back({face[0], face[1], face[2]});
  surface.parts.assign(surface.triangles.size(), 0);
  surface.part_names = {"facets"};
  body.query = std::make_shared<const geometry::SurfaceQuery>(std::move(surface));
  return body;
}

void expect_agreement(const GetfemCase& c, double size, double within) {
  if (!has_getfem()) GTEST_SKIP() << "no module getfem (Debian package python3-getfem)";
  const tool::Tool tool = tool::make_tool(c.scene.tools.at(0));
  Body body = prepare_body(c.scene, c.surface);
  const ContactFrame frame;
  solve::PairOptions options;
  options.mesh_size = c.mesh_size;
  options.growth = c.growth * size;
  options.max_size = body.diagonal / 8 * std::sqrt(size);
  const mesh::SizeField sizes =
      solve::contact_size({body, tool, tool.vertices.at(0), frame}, c.depths.back(), size, options);
  const mesh::VolumeMeshResult mesh = mesh::mesh_volume(body, sizes, {frame.origin}, options.mesh);
  ASSERT_TRUE(mesh.usable) << c.name << ": " << mesh.cause;
  body = of_facets(std::move(body), mesh.mesh);

  options.materials = {fem::make_material(c.scene.material).plain()};
  for (const RegionScene& region : c.scene.regions) {
    options.materials.push_back(fem::make_material(region.material).plain());
  }
  solve::PairPath path;
  path.normal_depths = c.depths;
  const PairResult ours = solve::solve_on_mesh({body, tool, tool.vertices.at(0), frame}, path, options, mesh.mesh);
  ASSERT_EQ(ours.samples.size(), c.depths.size()) << c.name << ": " << ours.outcome.cause;
  double seconds = 0;
  const auto theirs = solve_getfem(problem(c, tool, mesh.mesh, solve::fixed_nodes(body, mesh.mesh)), seconds);
  ASSERT_EQ(theirs.size(), c.depths.size()) << c.name;
  double difference = 0;
  std::string each;
  for (std::size_t k = 0; k < c.depths.size(); ++k) {
    const double force = solve::force_at(ours.samples[k], ours.samples[k > 0 ? k - 1 : 1], c.depths[k]).z();
    difference = std::max(difference, std::abs(force / theirs[k] - 1));
    each += fmt::format(" {:+.2f}", 100 * (force / theirs[k] - 1));
  }
  EXPECT_LT(difference, within) << c.name;
  fmt::print("{}: {} nodes, {} % apart; GetFEM {:.1f} s\n", c.name, mesh.mesh.nodes.size(), each, seconds);
}

// One law on a coarse mesh. On meshes of 300 to 450 nodes how contact is integrated over their faces matters: they are
// 0.8 to 2.8 % apart, those of more than 640 nodes 0.1 to 0.8 %.
TEST(Getfem, ForcesAgreeOnTheSameMesh) {
  expect_agreement(block("Mooney-Rivlin", material(Law::mooney_rivlin, 0.45), 4 * kRadius, 0.4 * kRadius), 1.6, 0.01);
}

class GetfemLong : public testing::TestWithParam<GetfemCase> {};

TEST_P(GetfemLong, ForcesAgreeOnTheSameMesh) { expect_agreement(GetParam(), 1.4, 0.01); }

std::vector<GetfemCase> getfem_cases() {
  const double thick = 4 * kRadius, deep = 0.4 * kRadius;
  std::vector<GetfemCase> cases;
  const auto soft = material(Law::neo_hookean, 0.3), wet = material(Law::neo_hookean, 0.45);
  for (const Law law : {Law::neo_hookean, Law::mooney_rivlin}) {
    for (const double poisson : {0.3, 0.45}) {
      const std::string name =
          fmt::format("{}_nu_{:03.0f}", law == Law::neo_hookean ? "neo_Hookean" : "Mooney_Rivlin", 100 * poisson);
      cases.push_back(block(name, material(law, poisson), thick, deep));
      cases.push_back(punch(block("punch_" + name, material(law, poisson), thick, deep)));
    }
  }
  cases.push_back(block("Veronda_Westmann", material(Law::veronda_westmann, 0.45), thick, deep));
  cases.push_back(block("Ogden", material(Law::ogden, 0.45), thick, deep));
  cases.push_back(block("Holzapfel", material(Law::holzapfel, 0.45), thick, deep));
  cases.push_back(block("St_Venant", material(Law::st_venant, 0.3), thick, 0.1 * kRadius));
  cases.push_back(block("linear", material(Law::linear, 0.3), thick, 0.2 * kRadius));
  cases.push_back(block("layer_nu_030", soft, 2 * kRadius, kRadius));
  cases.push_back(block("layer_nu_045", wet, 2 * kRadius, kRadius));
  cases.push_back(block("thin_layer_nu_045", wet, kRadius, 0.5 * kRadius));
  cases.back().mesh_size = 0.25;
  cases.push_back(ball("ball_on_a_cap", wet, 0, kRadius));
  cases.push_back(ball("thick_shell", wet, 1.5 * kRadius, kRadius));
  cases.push_back(ball("thin_shell", wet, 0.6 * kRadius, 0.6 * kRadius));
  cases.back().mesh_size = 0.35;
  cases.push_back(inclusion("hard_lump", 10, 0.4 * kRadius));
  cases.push_back(inclusion("soft_lump", 0.1, 0.4 * kRadius));
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Cases, GetfemLong, testing::ValuesIn(getfem_cases()),
                         [](const auto& c) { return c.param.name; });

}  // namespace
}  // namespace palpate::verify
