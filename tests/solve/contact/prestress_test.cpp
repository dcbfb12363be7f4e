// SPDX-License-Identifier: GPL-3.0-or-later
// Prestress against closed forms: weight, inner pressure, stretch, and contact on a stretched body.
#include "precompute/solve/contact/prestress.hpp"

#include "formats/io/error.hpp"
#include "precompute/fem/materials/material.hpp"
#include "precompute/solve/contact/settle.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "tests/support/block_mesh.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/finite_difference.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

// The unit cube on a mesh of its own; what holds it is added.
class Cube : public ::testing::Test {
protected:
  mesh::TetMesh mesh = test::block_mesh({0, 0.4, 1}, {0, 0.6, 1}, {0, 0.3, 0.5, 0.8, 1});
  Body body = test::block_body(0.5, 5e3, 0.45);
  VectorXd x;

  Cube() {
    body.query = std::make_shared<const geometry::SurfaceQuery>(test::box_surface({0, 0, 0}, {1, 1, 1}));
    body.supports.clear();
    body.support_surfaces.clear();
  }
  void hold(SupportScene::Type type, const Vector3d& point, const Vector3d& normal) {
    body.supports.push_back(test::half_space(type, point, normal));
    body.support_surfaces.emplace_back();
  }
  void slide(int axis, double at) {
    const double side = at > 0.5 ? -1 : 1;
    hold(SupportScene::Type::slider, (at + side * 1e-6) * Vector3d::Unit(axis), side * Vector3d::Unit(axis));
  }
  Settled settle(BodyEnergy& energy) {
    fem::Minimiser minimiser(mesh, energy.fixed());
    x = energy.rest();
    return solve::settle(energy, minimiser, x, 1e-12);
  }
};

// Between four sliders a hanging block stretches in one direction alone, where the law is linear in the stretch: the
// end sinks by rho g L^2 / 2 over that modulus, whatever the strain.
TEST_F(Cube, HangsUnderItsOwnWeight) {
  hold(SupportScene::Type::fixed, {0, 0, 1 - 1e-6}, {0, 0, -1});
  for (const int axis : {0, 1}) {
    slide(axis, 0);
    slide(axis, 1);
  }
  body.material.poisson = 0.3;
  const fem::Material m = fem::Material::neo_hookean(5e3, 0.3);
  const double modulus = m.mu + m.bulk;
  body.prestress.density = 1000;
  body.prestress.gravity = {0, 0, -0.6 * modulus / 1000};
  BodyEnergy energy(body, mesh);
  const Settled settled = settle(energy);
  ASSERT_TRUE(settled.reached) << settled.cause;
  EXPECT_GT(settled.steps, 3U);
  double sunk = 0;
  int count = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n].z() == 0) sunk -= x[3 * static_cast<Eigen::Index>(n) + 2], ++count;
  }
  EXPECT_NEAR(sunk / count, 0.3, 0.003);
}

// Sliders that move apart: uniaxial stress, and the work of the supports is that of the closed form.
TEST_F(Cube, StretchBetweenSlidersIsUniaxialStress) {
  slide(0, 0);
  slide(0, 1);
  slide(1, 0);
  slide(2, 0);
  body.prestress.stretch = {1.4, 1, 1};
  BodyEnergy energy(body, mesh);
  const Settled settled = settle(energy);
  ASSERT_TRUE(settled.reached) << settled.cause;
  double most = -1, least = 2, side = 0;
  int count = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const auto k = 3 * static_cast<Eigen::Index>(n);
    most = std::max(most, x[k]);
    least = std::min(least, x[k]);
    if (mesh.nodes[n].y() == 1) side += x[k + 1], ++count;
  }
  const fem::Material m = fem::Material::neo_hookean(5e3, 0.45);
  const double a = most - least, b = side / count;
  EXPECT_NEAR(a, 1.4, 1e-3);
  EXPECT_NEAR((most + least) / 2, 0.5, 1e-6);
  EXPECT_NEAR((m.mu * b + m.volumetric_slope(a * b * b) * a * b) / 5e3, 0, 1e-3);
  const double stress = m.mu * a + m.volumetric_slope(a * b * b) * b * b;
  EXPECT_NEAR(energy.slope(x).supports / (0.4 * stress), 1, 2e-3);
}

// Loads without an equilibrium are refused with the share that has one: a block between fixed ends, squeezed flat.
TEST_F(Cube, RefusesWhatIsNotBorne) {
  hold(SupportScene::Type::fixed, {0, 0, 1e-6}, {0, 0, 1});
  body.prestress.density = 1e5;
  body.prestress.gravity = {0, 0, -1000};
  BodyEnergy energy(body, mesh);
  const Settled settled = settle(energy);
  EXPECT_FALSE(settled.reached);
  EXPECT_LT(settled.share, 0.1);
  EXPECT_NE(settled.cause.find("has an equilibrium up to"), std::string::npos) << settled.cause;
}

// A ball of 30 mm with a void of 20 mm inside, on a bed that holds next to nothing.
Body hollow_ball(double young, double poisson, double pressure) {
  Surface both = test::sphere_surface({0, 0, 0}, 0.03, 4);
  const Surface inner = test::sphere_surface({0, 0, 0}, 0.02, 4);
  const auto first = static_cast<std::int32_t>(both.vertices.size());
  both.vertices.insert(both.vertices.end(), inner.vertices.begin(), inner.vertices.end());
  for (const auto& t : inner.triangles) both.triangles.push_back({t[0] + first, t[2] + first, t[1] + first});
  both.parts.assign(both.triangles.size(), 0);
  std::fill(both.parts.end() - static_cast<std::ptrdiff_t>(inner.triangles.size()), both.parts.end(), 1);
  both.part_names = {"outside", "void"};
  Scene scene;
  scene.material.young = young;
  scene.material.poisson = poisson;
  scene.prestress.pressure = pressure;
  scene.prestress.cavity = "void";
  scene.supports.push_back(test::half_space(SupportScene::Type::spring, {0, 0, 0}, {0, 0, 1}));
  scene.supports.back().stiffness = 300;
  return prepare_body(scene, both);
}

// Mean radius of the wall, by the vertices of the clean surface.
double radius(const Body& body, bool cavity) {
  double sum = 0;
  int count = 0;
  for (const Vector3d& v : body.query->surface().vertices) {
    if (body.in_cavity(v) == cavity) sum += v.norm(), ++count;
  }
  return sum / count;
}

TEST(HollowBall, UnderLittlePressureIsLames) {
  const double young = 5e3, nu = 0.3, p = 30, a = 0.02, b = 0.03;
  const Body body = apply_prestress(hollow_ball(young, nu, p));
  const auto moved = [&](double r) {
    return p * a * a * a / (young * (b * b * b - a * a * a)) * ((1 - 2 * nu) * r + (1 + nu) * b * b * b / (2 * r * r));
  };
  EXPECT_NEAR((radius(body, true) - a) / moved(a), 1, 0.02);
  EXPECT_NEAR((radius(body, false) - b) / moved(b), 1, 0.02);
  ASSERT_TRUE(body.stress_free);
  EXPECT_NEAR(radius(*body.stress_free, true), a, 1e-6);
  // Points go back to where they came from.
  const MaterialPoint from = body.material_point({0, 0.02 * radius(body, false) / 0.02, 0});
  EXPECT_NEAR(from.point.norm(), b, 0.01 * b);
}

// Pressure (Pa) that holds an incompressible neo-Hookean ball with its inner radius stretched by `inner`:
// p = 2 mu (integral of l^-2 + l^-5 from the outer to the inner stretch).
double inflation(double mu, double inner) {
  const double outer = std::cbrt(1 + 8.0 / 27 * (inner * inner * inner - 1));
  const auto potential = [](double l) { return 1 / l + 1 / (4 * l * l * l * l); };
  return 2 * mu * (potential(outer) - potential(inner));
}

// Settles a ball on elements of `edge` (m); the ratio of the void's volumes.
Settled inflate(double young, double pressure, double edge, double& growth) {
  const Body body = hollow_ball(young, 0.4999, pressure);
  const mesh::VolumeMeshResult made = mesh::mesh_volume(body, [=](const Vector3d&) { return edge; }, {});
  if (!made.usable) throw Error(ExitCode::numerical, made.cause);
  BodyEnergy energy(body, made.mesh);
  fem::Minimiser minimiser(made.mesh, energy.fixed());
  VectorXd x = energy.rest();
  const Settled settled = settle(energy, minimiser, x, 1e-9);
  growth = energy.cavity_volume(x) / energy.cavity_volume(energy.rest());
  return settled;
}

TEST(HollowBall, InflatesLikeTheNeoHookeanClosedForm) {
  const double young = 5e3;
  double growth = 0;
  const Settled settled = inflate(young, inflation(young / 3, 1.3), 0.009, growth);
  ASSERT_TRUE(settled.reached) << settled.cause;
  EXPECT_NEAR(std::cbrt(growth), 1.3, 0.02);  // straight edges of 9 mm cut off some of the ball
}

// Beyond the largest pressure that any radius holds, there is no equilibrium to be found.
TEST(HollowBall, BeyondTheLimitLoadIsRefused) {
  const double young = 5e3;
  double limit = 0, growth = 0;
  for (double l = 1; l < 4; l += 0.01) limit = std::max(limit, inflation(young / 3, l));
  const Settled settled = inflate(young, 1.25 * limit, 0.012, growth);
  EXPECT_FALSE(settled.reached);
  EXPECT_LT(settled.share, 0.83);
  EXPECT_GT(settled.share, 0.7);
  EXPECT_NE(settled.cause.find("has an equilibrium up to"), std::string::npos) << settled.cause;
}

TEST(Prestress, PressureWithoutACavityIsAWrongScene) {
  Body body = test::block_body(0.03, 5e3, 0.49);
  body.prestress.pressure = 100;
  EXPECT_THROW(apply_prestress(body), Error);
}

TEST(Prestress, NoneLeavesTheBodyAsItIs) {
  const Body body = apply_prestress(test::block_body(0.03, 5e3, 0.49));
  EXPECT_FALSE(body.stress_free);
  EXPECT_EQ(body.material_point({0.1, 0.2, 0.3}).point, Vector3d(0.1, 0.2, 0.3));
}

struct Pressed {
  PairResult result;
  double force = 0.0, depth = 0.0;
};

Pressed press(const Body& body, double radius, double depth, double mesh_size = 0.3) {
  ToolScene sphere;
  sphere.radius = radius;
  const tool::Tool tool = tool::make_tool(sphere);
  PairPath path;
  path.normal_depths = {0.25 * depth, 0.5 * depth, 0.75 * depth, depth};
  ContactFrame frame;
  frame.origin = body.query->closest({0, 0, 0}).point;
  PairOptions options;
  options.mesh_size = mesh_size;
  Pressed pressed{solve_pair({body, tool, tool.vertices[0], frame}, path, options)};
  if (!pressed.result.samples.empty()) {
    pressed.force = pressed.result.samples.back().force.z();
    pressed.depth = pressed.result.samples.back().deflection.z();
  }
  return pressed;
}

// A small indentation of a half-space that is stretched alike in its two directions by l: the force without stretch
// (which others hold to Hertz; here both blocks are of one size, and end alike) times
// (x^3 + x^2 + 3 x - 1) / (2 l^4 (x + 1)), x = l^3 (incompressible
// neo-Hookean; small deformations superposed on finite
// ones, Green, Rivlin and Shield 1952; it vanishes at Biot's surface instability l = 0.666).
TEST(Prestress, ContactOnAStretchedBlockIsStifferByTheClosedForm) {
  const double young = 5e3, nu = 0.49, tip = 0.01, depth = 0.01 * tip, half = 40 * std::sqrt(tip * depth), l = 1.3;
  Body body = test::block_body(half, young, nu);
  body.supports.clear();
  body.support_surfaces.clear();
  const double inside = half * (1 - 1e-6);
  for (const Vector3d& side : {Vector3d(1, 0, 0), Vector3d(-1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, -1, 0)}) {
    body.supports.push_back(test::half_space(SupportScene::Type::slider, inside * side, -side));
  }
  body.supports.push_back(test::half_space(SupportScene::Type::slider, {0, 0, -inside}, {0, 0, 1}));
  body.support_surfaces.resize(5);
  body.prestress.stretch = {l, l, 1};
  const Body plain = test::block_body(half, young, nu), stretched = apply_prestress(body);
  // An incompressible block thins by 1 / l^2; this one by 1 % of its height less.
  EXPECT_NEAR(stretched.query->closest({0, 0, 0}).point.z(), -half * (1 - 1 / (l * l)), 0.01 * half);
  const Pressed without = press(plain, tip, depth, 0.2), with = press(stretched, tip, depth, 0.2);
  for (const Pressed* pressed : {&without, &with}) {
    ASSERT_TRUE(pressed->result.outcome.accepted) << pressed->result.outcome.cause;
  }
  const double x = l * l * l, stiffer = (x * x * x + x * x + 3 * x - 1) / (2 * std::pow(l, 4) * (x + 1));
  // Depths are those of the solves: of either contact the same power.
  const double deeper = std::pow(with.depth / without.depth, 1.5);
  EXPECT_NEAR(with.force / without.force / deeper / stiffer, 1, 0.025);
  EXPECT_GT(stiffer, 1.14);
}

// Pressed under its own weight the block answers through the same gates; its weight changes little at this depth, and
// the energy that the tool's work is compared with counts it.
TEST(Prestress, ContactUnderWeightPassesTheGates) {
  Body body = test::block_body(0.03, 5e3, 0.49);
  const Pressed without = press(body, 0.005, 0.004);
  ASSERT_TRUE(without.result.outcome.accepted) << without.result.outcome.cause;
  body.prestress.gravity = {0, 0, -2 * 9.81};
  EXPECT_FALSE(press(body, 0.005, 0.004).result.outcome.accepted);  // the loads have not acted
  const Body heavy = apply_prestress(body);
  EXPECT_LT(heavy.query->closest({0, 0, 0}).point.z(), -5e-4);
  const Pressed with = press(heavy, 0.005, 0.004);
  ASSERT_TRUE(with.result.outcome.accepted) << with.result.outcome.cause;
  EXPECT_NEAR(with.force / without.force, 1, 0.1);
  EXPECT_NE(with.force, without.force);
}

}  // namespace
}  // namespace palpate::solve
