// SPDX-License-Identifier: GPL-3.0-or-later
// The sum that a bake minimises, with every load and support at once: its derivatives by the nodes and by the loads'
// share.
#include "precompute/solve/contact/body_energy.hpp"

#include "tests/fem/deformed_block.hpp"
#include "tests/fem/hollow_block.hpp"
#include "tests/support/bodies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace palpate::fem {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

// Moduli and loads of one size, so that none hides behind another.
Body loaded_body() {
  Body body;
  body.query = std::make_shared<const geometry::SurfaceQuery>(test::box_surface({0, 0, 0}, {3, 3, 3}));
  body.material.poisson = 0.4;
  body.diagonal = 1e4;  // makes the slider as soft as the rest
  body.capsule_thickness = 0.05;
  body.capsule_young = 3e4;
  body.prestress.gravity = {2, -3, -9};
  body.prestress.density = 1000;
  body.prestress.pressure = 4000;
  body.prestress.stretch = {1.1, 1, 0.9};
  body.supports = {test::half_space(SupportScene::Type::spring, {0, 0, 1e-6}, {0, 0, 1}),
                   test::half_space(SupportScene::Type::slider, {1e-6, 0, 0}, {1, 0, 0})};
  body.supports[0].stiffness = 5e3;
  body.support_surfaces.resize(2);
  return body;
}

class EveryLoad : public ::testing::Test {
protected:
  static constexpr double kShare = 0.4;
  mesh::TetMesh mesh = test::hollow_block();
  Body body = loaded_body();
  solve::BodyEnergy energy{body, mesh};
  VectorXd x;

  EveryLoad() {
    energy.set_share(kShare);
    Eigen::Matrix3d f;
    f << 1.1, 0.1, 0, -0.05, 0.95, 0.1, 0.05, 0, 0.9;
    std::mt19937 engine(9);
    x = test::shaken(test::mapped(mesh, f), 0.05, engine);
  }
};

TEST_F(EveryLoad, DerivativesMatchDifferences) {
  EXPECT_LT(test::gradient_error(energy, x, 1e-5), 1e-7);
  EXPECT_LT(test::hessian_error(energy, mesh, x, 1e-5), 1e-7);
  VectorXd g(x.size());
  EXPECT_NEAR(energy.gradient(x, g) / energy.value(x), 1, 1e-12);
}

// No node is held: what the energy grows by at a fixed x is the slope that load steps are judged by.
TEST_F(EveryLoad, SlopeIsTheDerivativeByTheShare) {
  const solve::BodyEnergy::Slope slope = energy.slope(x);
  EXPECT_GT(std::abs(slope.forces), 1.0);
  EXPECT_GT(std::abs(slope.supports), 1.0);
  energy.set_share(kShare + 1e-3);
  const double up = energy.value(x);
  energy.set_share(kShare - 1e-3);
  const double down = energy.value(x);
  EXPECT_NEAR((up - down) / 2e-3 / (slope.forces + slope.supports), 1, 1e-8);
}

}  // namespace
}  // namespace palpate::fem
