// SPDX-License-Identifier: GPL-3.0-or-later
// Elastic beds and sliders: derivatives, closed forms of a bar and of a stiff block, balance with a tool.
#include "precompute/solve/contact/bed.hpp"

#include "precompute/fem/minimiser.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "tests/support/block_mesh.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/loaded.hpp"

#include <gtest/gtest.h>

#include <random>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

// Traction (Pa) along z on the faces in the plane z = 1.
VectorXd top_load(const mesh::TetMesh& mesh, double traction) {
  return test::face_loads(mesh, [&](const Vector3d& middle, const Vector3d&, const Vector3d&) {
    return Vector3d(0, 0, middle.z() > 1 - 1e-9 ? traction : 0);
  });
}

class Beds : public ::testing::Test {
protected:
  mesh::TetMesh mesh = test::block_mesh({0, 0.4, 1}, {0, 0.6, 1}, {0, 0.5, 1});
  VectorXd rest = test::stacked(mesh);
  Body body;

  fem::ElasticEnergy elastic_energy() const {
    return {mesh, {fem::Material::neo_hookean(body.material.young, body.material.poisson)}};
  }

  VectorXd solve(const VectorXd& force) const {
    const fem::ElasticEnergy elastic = elastic_energy();
    const BedEnergy bed(body, mesh);
    const test::Loaded problem(elastic, force, &bed);
    fem::Minimiser minimiser(mesh, std::vector<char>(mesh.nodes.size(), 0));
    VectorXd x = rest;
    fem::MinimiserOptions options;
    options.energy_tolerance = 1e-12;
    options.residual_tolerance = 1e-6;
    const fem::MinimiserResult r = minimiser.minimise(problem, x, options);
    EXPECT_TRUE(r.converged) << r.cause;
    return x;
  }
};

TEST_F(Beds, DerivativesMatchDifferences) {
  body.diagonal = 1.7;
  body.supports = {test::half_space(SupportScene::Type::spring, {0, 0, 1e-6}, {0, 0, 1}),
                   test::half_space(SupportScene::Type::slider, {1e-6, 0, 0}, {1, 0, 0})};
  body.support_surfaces.resize(2);
  const fem::ElasticEnergy elastic = elastic_energy();
  const BedEnergy bed(body, mesh);
  const test::Loaded problem(elastic, VectorXd::Zero(rest.size()), &bed);
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> noise(-0.1, 0.1);
  VectorXd x = rest;
  for (auto& v : x) v += noise(engine);
  EXPECT_LT(test::gradient_error(problem, x, 1e-5), 1e-6);
  EXPECT_LT(test::hessian_error(problem, mesh, x, 1e-5), 1e-6);
}

// A bar on three sliders is in uniaxial stress: what a fixed end would not give.
TEST_F(Beds, SlidersLeaveABarToUniaxialStress) {
  body.material.young = 5e3;
  body.material.poisson = 0.45;
  body.diagonal = 1.7;
  for (const Vector3d& n : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)}) {
    body.supports.push_back(test::half_space(SupportScene::Type::slider, 1e-6 * n, n));
  }
  body.support_surfaces.resize(3);
  const VectorXd x = solve(top_load(mesh, -600));
  double top = 0, side = 0;
  int tops = 0, sides = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const auto k = 3 * static_cast<Eigen::Index>(n);
    if (mesh.nodes[n].z() > 1 - 1e-9) top += x[k + 2], ++tops;
    if (mesh.nodes[n].x() > 1 - 1e-9) side += x[k], ++sides;
  }
  const double a = top / tops, b = side / sides;
  const fem::Material m = fem::Material::neo_hookean(5e3, 0.45);
  EXPECT_NEAR((m.mu * a + m.volumetric_slope(a * b * b) * b * b) / -600, 1.0, 1e-3);
  EXPECT_NEAR((m.mu * b + m.volumetric_slope(a * b * b) * a * b) / 600, 0.0, 1e-3);
  EXPECT_LT(a, 0.92);
}

// Under a stiff block the bed gives by traction over stiffness.
TEST_F(Beds, AStiffBlockSinksByTractionOverStiffness) {
  body.material.young = 1e7;
  body.diagonal = 1.7;
  body.supports = {test::half_space(SupportScene::Type::spring, {0, 0, 1e-6}, {0, 0, 1})};
  body.support_surfaces.resize(1);
  const VectorXd x = solve(top_load(mesh, -200));
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const auto k = 3 * static_cast<Eigen::Index>(n);
    EXPECT_NEAR(x[k + 2] - rest[k + 2], -200 / 1e5, 3e-5);
  }
}

// The same press, block and depth: the looser the support, the softer the answer; a stiff bed is a fixed one.
TEST(LooseSupports, AnswerMoreSoftly) {
  const auto force_on = [](SupportScene::Type type, double stiffness) {
    Body block = test::block_body(0.03, 5e3, 0.49);
    block.supports[0].type = type;
    block.supports[0].stiffness = stiffness;
    if (type == SupportScene::Type::slider) {
      block.supports.push_back(test::half_space(SupportScene::Type::fixed, {-0.03 + 1e-7, 0, 0}, {1, 0, 0}));
      block.support_surfaces.emplace_back();
    }
    Scene scene;
    scene.sampling.normal_points = 4;
    const tool::Tool tool = tool::make_tool(ToolScene{});
    const PairResult r =
        solve_pair({block, tool, tool.vertices[0], ContactFrame{}}, bake_path(scene, 0.004), pair_options(scene));
    EXPECT_TRUE(r.outcome.accepted) << r.outcome.cause;
    return r.samples.empty() ? 0.0 : r.samples.back().force.z();
  };
  const double fixed = force_on(SupportScene::Type::fixed, 0);
  EXPECT_NEAR(force_on(SupportScene::Type::spring, 1e9) / fixed, 1.0, 0.01);
  // 60 x 60 mm of 1e4 N/m^3 are 36 N/m, about the contact's own stiffness.
  const double soft = force_on(SupportScene::Type::spring, 1e4);
  EXPECT_LT(soft, 0.8 * fixed);
  EXPECT_GT(soft, 0.2 * fixed);
  const double sliding = force_on(SupportScene::Type::slider, 0);
  EXPECT_LT(sliding, fixed);
  EXPECT_GT(sliding, 0.8 * fixed);
}

}  // namespace
}  // namespace palpate::solve
