// SPDX-License-Identifier: GPL-3.0-or-later
// Elastic beds and sliders: derivatives, closed forms of a bar and of a stiff block, balance with a tool.
#include "precompute/solve/bed.hpp"

#include "precompute/fem/minimiser.hpp"
#include "precompute/solve/pair.hpp"
#include "tests/support/block_mesh.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/finite_difference.hpp"

#include <gtest/gtest.h>

#include <random>

namespace palpate {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

// A body on supports under a dead force on each node.
class Held final : public EnergyProblem {
public:
  Held(const Body& body, const TetMesh& mesh, VectorXd force)
      : elastic_(mesh, {Material::neo_hookean(body.material.young, body.material.poisson)}),
        bed_(body, mesh),
        force_(std::move(force)) {}
  double value(const VectorXd& x) const override { return elastic_.value(x) + bed_.value(x) - force_.dot(x); }
  double gradient(const VectorXd& x, VectorXd& g) const override {
    g = -force_;
    return elastic_.gradient(x, g) + bed_.gradient(x, g) - force_.dot(x);
  }
  void hessian(const VectorXd& x, HessianKind kind, BlockMatrix& m) const override {
    elastic_.hessian(x, kind, m);
    bed_.hessian(m);
  }
  double load(const VectorXd&) const override { return force_.norm(); }

private:
  ElasticEnergy elastic_;
  BedEnergy bed_;
  VectorXd force_;
};

SupportScene half_space(SupportScene::Type type, const Vector3d& point, const Vector3d& normal) {
  SupportScene s;
  s.kind = SupportScene::Kind::half_space;
  s.type = type;
  s.stiffness = 1e5;
  s.point = point;
  s.normal = normal;
  return s;
}

// Traction (Pa) along z on the faces in the plane z = 1.
VectorXd top_load(const TetMesh& mesh, double traction) {
  VectorXd force = VectorXd::Zero(3 * static_cast<Eigen::Index>(mesh.nodes.size()));
  for (const auto& f : mesh.faces) {
    const Vector3d &a = mesh.nodes[f[0]], &b = mesh.nodes[f[1]], &c = mesh.nodes[f[2]];
    if (a.z() + b.z() + c.z() < 3 - 1e-9) continue;
    for (int k = 3; k < 6; ++k) force[3 * f[k] + 2] += traction * 0.5 * (b - a).cross(c - a).norm() / 3;
  }
  return force;
}

class Beds : public ::testing::Test {
protected:
  TetMesh mesh = test::block_mesh({0, 0.4, 1}, {0, 0.6, 1}, {0, 0.5, 1});
  VectorXd rest = test::stacked(mesh);
  Body body;

  VectorXd solve(const VectorXd& force) const {
    const Held problem(body, mesh, force);
    Minimiser minimiser(mesh, std::vector<char>(mesh.nodes.size(), 0));
    VectorXd x = rest;
    MinimiserOptions options;
    options.energy_tolerance = 1e-12;
    options.residual_tolerance = 1e-6;
    const MinimiserResult r = minimiser.minimise(problem, x, options);
    EXPECT_TRUE(r.converged) << r.cause;
    return x;
  }
};

TEST_F(Beds, DerivativesMatchDifferences) {
  body.diagonal = 1.7;
  body.supports = {half_space(SupportScene::Type::spring, {0, 0, 1e-6}, {0, 0, 1}),
                   half_space(SupportScene::Type::slider, {1e-6, 0, 0}, {1, 0, 0})};
  body.support_surfaces.resize(2);
  const Held problem(body, mesh, VectorXd::Zero(rest.size()));
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
    body.supports.push_back(half_space(SupportScene::Type::slider, 1e-6 * n, n));
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
  const Material m = Material::neo_hookean(5e3, 0.45);
  EXPECT_NEAR((m.mu * a + m.volumetric_slope(a * b * b) * b * b) / -600, 1.0, 1e-3);
  EXPECT_NEAR((m.mu * b + m.volumetric_slope(a * b * b) * a * b) / 600, 0.0, 1e-3);
  EXPECT_LT(a, 0.92);
}

// Under a stiff block the bed gives by traction over stiffness.
TEST_F(Beds, AStiffBlockSinksByTractionOverStiffness) {
  body.material.young = 1e7;
  body.diagonal = 1.7;
  body.supports = {half_space(SupportScene::Type::spring, {0, 0, 1e-6}, {0, 0, 1})};
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
      block.supports.push_back(half_space(SupportScene::Type::fixed, {-0.03 + 1e-7, 0, 0}, {1, 0, 0}));
      block.support_surfaces.emplace_back();
    }
    Scene scene;
    scene.sampling.normal_points = 4;
    const Tool tool = make_tool(ToolScene{});
    const PairResult r =
        solve_pair(block, tool, tool.vertices[0], ContactFrame{}, bake_path(scene, 0.004), pair_options(scene));
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
}  // namespace palpate
