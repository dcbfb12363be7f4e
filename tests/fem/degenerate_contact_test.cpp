// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of contact and friction on bodies that are flat, inside out, a needle, a point: by every method that
// keeps the tool out.
#include "precompute/solve/contact/friction.hpp"

#include "precompute/tool/shapes.hpp"
#include "tests/fem/deformed_block.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <random>

namespace palpate::fem {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

class DegenerateContact : public ::testing::TestWithParam<Vector3d> {
protected:
  static constexpr double kPenalty = 1e4;
  mesh::TetMesh mesh = test::block_mesh({0, 0.5, 1}, {0, 0.5, 1}, {0, 1});
  std::shared_ptr<const tool::ToolShape> sphere = tool::make_sphere(0.5);
  solve::ContactEnergy contact{mesh, std::vector<char>(mesh.nodes.size(), 0), *sphere, Eigen::Isometry3d::Identity()};
  std::mt19937 engine{7};
  VectorXd x = test::shaken(test::mapped(mesh, GetParam().asDiagonal()), 0.03, engine);

  DegenerateContact() {
    contact.set_rotation(Eigen::AngleAxisd(0.3, Vector3d(1, 2, 0.5).normalized()).toRotationMatrix());
    contact.set_penalty(kPenalty);
    contact.set_anchor_stiffness(0.5 * kPenalty);
  }

  // From above the body's middle down to this gap.
  void lower_to(double gap) {
    Vector3d at = 0.5 * GetParam() + Vector3d(0.03, -0.04, 2.0);
    contact.set_translation(at);
    for (int k = 0; k < 100; ++k) {
      at.z() -= contact.gap(x) - gap;
      contact.set_translation(at);
    }
    ASSERT_NEAR(contact.gap(x), gap, 1e-3);
  }
  void expect_derivatives(const EnergyProblem& problem, const char* method) const {
    EXPECT_LT(test::gradient_error(problem, x, 1e-6), 1e-6) << method;
    EXPECT_LT(test::hessian_error(problem, mesh, x, 1e-7), 1e-6) << method;
  }
};

TEST_P(DegenerateContact, DerivativesMatchDifferencesByEveryMethod) {
  const test::Alone problem(contact);
  lower_to(-0.1);
  ASSERT_GT(contact.report(x).points, 0U);
  expect_derivatives(problem, "penalty");

  // The tool is lifted: points with a gap answer as well.
  contact.augment(x);
  lower_to(-0.03);
  ASSERT_GT(contact.report(x).points, contact.touching(x).size());
  expect_derivatives(problem, "multipliers");
  contact.set_multipliers({});

  contact.stick(x);
  x = test::shaken(x, 0.01, engine);
  ASSERT_GT(contact.report(x).tangential_energy, 0.0);
  expect_derivatives(problem, "anchors");
  contact.bond(x);
  contact.set_translation(contact.translation() + Vector3d(0.01, 0, 0.04));
  ASSERT_GT(contact.report(x).bond_gap, 0.0);
  expect_derivatives(problem, "bonds");
}

// Gaps on both sides of the floor, beyond which the barrier goes on as a parabola.
TEST_P(DegenerateContact, DerivativesOfABarrierMatchDifferences) {
  constexpr double kThickness = 0.1, kFloor = 0.02;
  lower_to(-0.01);
  contact.set_barrier(kFloor, 0.5 * kFloor);
  const std::uint32_t beneath = contact.report(x).points;
  contact.set_barrier(kThickness, kFloor);
  ASSERT_GT(beneath, 0U);
  ASSERT_GT(contact.report(x).points, beneath);
  expect_derivatives(test::Alone(contact), "barrier");
}

TEST_P(DegenerateContact, DerivativesOfFrictionMatchDifferences) {
  lower_to(-0.1);
  solve::FrictionEnergy friction(contact, 0.4, 2 * kPenalty);
  friction.begin(x);
  contact.set_translation(contact.translation() + Vector3d(0.01, 0.003, -0.001));
  friction.hold(x);
  x = test::shaken(x, 0.01, engine);
  const solve::FrictionReport r = friction.report(x);
  EXPECT_GT(r.slipping, 0.02);
  EXPECT_LT(r.slipping, 0.98);
  expect_derivatives(test::Alone(friction), "friction");
}

INSTANTIATE_TEST_SUITE_P(States, DegenerateContact, ::testing::ValuesIn(test::kDegenerate));

}  // namespace
}  // namespace palpate::fem
