// SPDX-License-Identifier: GPL-3.0-or-later
// Coulomb friction: derivatives, the law of a single step, where points land, what slip dissipates.
#include "precompute/solve/contact/friction.hpp"

#include "precompute/fem/minimiser.hpp"
#include "precompute/tool/shapes.hpp"
#include "tests/support/block_mesh.hpp"
#include "tests/support/finite_difference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

Eigen::Isometry3d pose(const Vector3d& at, double turn) {
  Eigen::Isometry3d p = Eigen::Isometry3d::Identity();
  p.linear() = Eigen::AngleAxisd(turn, Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
  p.translation() = at;
  return p;
}

// Over the block's top, from contacts that all stick to contacts that all slip.
class FrictionOfSlip : public ::testing::TestWithParam<double> {};

TEST_P(FrictionOfSlip, DerivativesMatchDifferences) {
  const mesh::TetMesh mesh = test::block_mesh({0, 0.5, 1}, {0, 0.5, 1}, {0, 1});
  const auto sphere = tool::make_sphere(0.5);
  ContactEnergy contact(mesh, std::vector<char>(mesh.nodes.size(), 0), *sphere, pose({0.31, 0.42, 1.37}, 0.3));
  contact.set_penalty(1e4);
  VectorXd x = test::stacked(mesh);
  FrictionEnergy friction(contact, 0.4, 2e4);
  friction.begin(x);
  contact.set_translation(contact.translation() + GetParam() * Vector3d(1, 0.3, -0.1));
  friction.hold(x);
  for (Eigen::Index k = 0; k < x.size(); ++k) x[k] += 0.2 * GetParam() * std::sin(3.0 * static_cast<double>(k));
  const FrictionReport r = friction.report(x);
  ASSERT_GT(r.limit, 0);
  const test::Alone problem(friction);
  EXPECT_LT(test::gradient_error(problem, x, 1e-3 * GetParam()), 1e-5) << r.slipping << " slips";
  EXPECT_LT(test::hessian_error(problem, mesh, x, 1e-4 * GetParam()), 1e-4) << r.slipping << " slips";

  // The reported force is the derivative of the energy along the tool's motion; tractions never pass their limits.
  const Vector3d at = contact.translation();
  const double step = 1e-4 * GetParam();
  for (int k = 0; k < 3; ++k) {
    contact.set_translation(at + step * Vector3d::Unit(k));
    const double up = friction.value(x);
    contact.set_translation(at - step * Vector3d::Unit(k));
    const double down = friction.value(x);
    EXPECT_NEAR(-(up - down) / (2 * step), r.force[k], 1e-4 * r.force.norm());
  }
  EXPECT_LE(r.traction, r.limit * (1 + 1e-12));
  EXPECT_EQ(r.slipping > 0.99, GetParam() > 0.2);
  EXPECT_EQ(r.slipping < 0.01, GetParam() < 0.01);
}
INSTANTIATE_TEST_SUITE_P(Steps, FrictionOfSlip, ::testing::Values(1e-5, 3e-3, 0.02, 0.3));

// A punch that covers the whole face with the same pressure everywhere, on nodes that stay: one point's law, times
// area.
class FrictionLaw : public ::testing::Test {
protected:
  static constexpr double kPenalty = 1e4, kOverlap = 0.01, kStiffness = 2e4, kMu = 0.3;
  const double limit = kMu * kPenalty * kOverlap, elastic = limit / kStiffness;  // N on 1 m^2; m
  const mesh::TetMesh mesh = test::block_mesh({0, 0.5, 1}, {0, 0.5, 1}, {0, 1});
  const VectorXd x = test::stacked(mesh);
  const std::shared_ptr<const tool::ToolShape> punch = tool::make_punch(3.0, 0.3, 4.0);
  ContactEnergy contact{mesh, std::vector<char>(mesh.nodes.size(), 0), *punch, pose({0.5, 0.5, 1 - kOverlap}, 0)};
  FrictionEnergy friction{contact, kMu, kStiffness};

  void SetUp() override { contact.set_penalty(kPenalty); }

  double step_to(double side, double overlap = kOverlap) {
    friction.begin(x);
    contact.set_translation({0.5 + side, 0.5, 1 - overlap});
    friction.hold(x);
    return friction.settle(x);
  }
};

TEST_F(FrictionLaw, SticksThenSlipsAtTheLimitAndDissipatesItsWork) {
  EXPECT_EQ(step_to(0.5 * elastic), 0.0);
  EXPECT_NEAR(friction.report(x).force.x(), -0.5 * limit, 1e-9 * limit);
  EXPECT_NEAR(friction.report(x).stored, 0.5 * 0.25 * limit * elastic, 1e-9 * limit * elastic);
  EXPECT_EQ(friction.report(x).slipping, 0.0);
  EXPECT_NEAR(step_to(11 * elastic), 10 * limit * elastic, 1e-9 * limit * elastic);
  EXPECT_NEAR(friction.report(x).force.x(), -limit, 1e-9 * limit);
  EXPECT_NEAR(friction.report(x).slipping, 1.0, 1e-12);
  EXPECT_NEAR(friction.report(x).pressure, kPenalty * kOverlap, 1e-9);
  // Back by twice the elastic slip the traction has turned round without any loss; beyond it slips the other way.
  EXPECT_NEAR(step_to(9.5 * elastic), 0.0, 1e-9 * limit * elastic);
  EXPECT_NEAR(friction.report(x).force.x(), 0.5 * limit, 1e-9 * limit);
  EXPECT_NEAR(step_to(8 * elastic), limit * elastic, 1e-9 * limit * elastic);
  EXPECT_NEAR(friction.report(x).force.x(), limit, 1e-9 * limit);
}

TEST_F(FrictionLaw, LimitsFollowThePressureAndPointsThatLeaveForgetTheirAnchors) {
  step_to(10 * elastic);
  friction.begin(x);
  contact.set_translation({0.5 + 10 * elastic, 0.5, 1 - 0.5 * kOverlap});
  EXPECT_NEAR(friction.mismatch(x).points, 1.0, 1e-9);  // held limits are twice those of half the overlap
  friction.hold(x, 0.5);
  EXPECT_NEAR(friction.mismatch(x).sum, 0.5, 1e-9);
  friction.hold(x);
  EXPECT_NEAR(friction.mismatch(x).points, 0.0, 1e-12);
  friction.settle(x);
  EXPECT_NEAR(friction.report(x).force.x(), -0.5 * limit, 1e-9 * limit);
  // On the way out it slips by half of what the tool moves, with a traction that falls to nothing.
  friction.begin(x);
  EXPECT_NEAR(step_to(20 * elastic, -0.5 * kOverlap), 0.8 * 0.5 * limit * 5 * elastic, 1e-9 * limit * elastic);
  EXPECT_TRUE(friction.anchors().empty());
  EXPECT_EQ(friction.report(x).limit, 0.0);
}

TEST_F(FrictionLaw, PointsLandHalfway) {
  contact.set_translation({0.5, 0.5, 1 + kOverlap});
  step_to(1.2 * elastic);
  EXPECT_NEAR(friction.report(x).force.x(), -0.6 * limit, 1e-9 * limit);
  contact.set_translation({0.5, 0.5, 1 + kOverlap});
  friction.set_anchors({});
  EXPECT_NEAR(step_to(20 * elastic), 0.8 * limit * 9 * elastic, 1e-9 * limit * elastic);  // the limit grew from nothing
  EXPECT_NEAR(friction.report(x).force.x(), -limit, 1e-9 * limit);
}

// Turned about its own axis, a disc of uniform pressure answers with the moment 2/3 mu P R.
TEST_F(FrictionLaw, TwistAnswersWithItsMoment) {
  const mesh::TetMesh fine = test::block_mesh({0, 0.2, 0.4, 0.6, 0.8, 1}, {0, 0.2, 0.4, 0.6, 0.8, 1}, {0, 1});
  const VectorXd rest = test::stacked(fine);
  const auto disc = tool::make_punch(0.4, 0.004, 4.0);
  ContactEnergy top(fine, std::vector<char>(fine.nodes.size(), 0), *disc, pose({0.5, 0.5, 1 - kOverlap / 10}, 0));
  top.set_penalty(kPenalty);
  FrictionEnergy twist(top, kMu, 100 * kStiffness);
  twist.begin(rest);
  top.set_rotation(Eigen::AngleAxisd(0.1, Vector3d::UnitZ()).toRotationMatrix());
  twist.hold(rest);
  twist.settle(rest);
  const FrictionReport r = twist.report(rest);
  EXPECT_NEAR(twist.moment(rest, {0.5, 0.5, 1}).z() / (-2.0 / 3 * kMu * r.pressure * 0.4), 1.0, 0.01);
  EXPECT_LT(r.force.norm(), 0.01 * r.traction);
}

}  // namespace
}  // namespace palpate::solve
