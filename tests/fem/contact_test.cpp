// SPDX-License-Identifier: GPL-3.0-or-later
// Contact energy: derivatives of every tool and of the anchors, and the forces that it reports.
#include "precompute/solve/contact/contact.hpp"

#include "precompute/tool/shapes.hpp"
#include "tests/support/block_mesh.hpp"
#include "tests/support/finite_difference.hpp"

#include <gtest/gtest.h>

namespace palpate::fem {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

struct Case {
  const char* name;
  std::shared_ptr<const tool::ToolShape> shape;
  Vector3d at;
};

class ContactOfTool : public ::testing::TestWithParam<int> {
protected:
  static Case make(int k) {
    switch (k) {
      case 0:
        return {"sphere", tool::make_sphere(0.5), {0.31, 0.42, 1.37}};
      case 1:
        return {"capsule tip", tool::make_capsule(0.4, 1.0), {0.33, 0.41, 1.29}};
      case 2:
        return {"punch", tool::make_punch(0.45, 0.1, 1.0), {0.33, 0.41, 0.93}};
      default:
        return {"capsule stem", tool::make_capsule(0.3, 2.0), {0.31, 0.42, 0.2}};
    }
  }
};

TEST_P(ContactOfTool, DerivativesMatchDifferences) {
  const Case c = make(GetParam());
  const mesh::TetMesh mesh = test::block_mesh({0, 0.5, 1}, {0, 0.5, 1}, {0, 1});
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(0.3, Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
  pose.translation() = c.at;
  solve::ContactEnergy contact(mesh, std::vector<char>(mesh.nodes.size(), 0), *c.shape, pose);
  contact.set_penalty(1e4);
  contact.set_anchor_stiffness(5e3);
  VectorXd x = test::stacked(mesh);
  ASSERT_GT(contact.report(x).points, 0u) << c.name;
  const test::Alone problem(contact);
  EXPECT_LT(test::gradient_error(problem, x, 1e-6), 1e-5) << c.name;
  EXPECT_LT(test::hessian_error(problem, mesh, x, 1e-7), 1e-4) << c.name;

  contact.stick(x);
  for (Eigen::Index k = 0; k < x.size(); ++k) x[k] += 0.01 * std::sin(3.0 * static_cast<double>(k));
  EXPECT_GT(contact.report(x).tangential_energy, 0.0);
  EXPECT_LT(test::gradient_error(problem, x, 1e-6), 1e-5) << c.name << " anchored";
  EXPECT_LT(test::hessian_error(problem, mesh, x, 1e-7), 1e-4) << c.name << " anchored";

  // Bonded points are held from outside as well: the tool is pulled half out of the contact.
  contact.bond(x);
  const std::uint32_t bonded = contact.report(x).points;
  contact.set_translation(contact.translation() + Vector3d(0.01, 0, 0.05));
  contact.release(x);
  EXPECT_GE(contact.report(x).points, bonded);
  EXPECT_GT(contact.report(x).bond_give.norm(), 1e-3);
  EXPECT_GT(contact.report(x).bond_gap, 0.01);
  EXPECT_LT(test::gradient_error(problem, x, 1e-6), 1e-5) << c.name << " bonded";
  EXPECT_LT(test::hessian_error(problem, mesh, x, 1e-7), 1e-4) << c.name << " bonded";

  // The reported force and moment are the derivatives of the energy along the tool's motion.
  const Vector3d at = contact.translation(), force = contact.report(x).force, moment = contact.report(x).moment;
  const Eigen::Matrix3d rest = contact.pose().linear();
  for (int k = 0; k < 3; ++k) {
    contact.set_translation(at + 1e-6 * Vector3d::Unit(k));
    const double up = contact.value(x);
    contact.set_translation(at - 1e-6 * Vector3d::Unit(k));
    const double down = contact.value(x);
    EXPECT_NEAR(-(up - down) / 2e-6, force[k], 1e-5 * force.norm());
    contact.set_translation(at);
    const auto turned = [&](double angle) {
      contact.set_rotation(Eigen::AngleAxisd(angle, Vector3d::Unit(k)) * rest);
      return contact.value(x);
    };
    EXPECT_NEAR(-(turned(1e-6) - turned(-1e-6)) / 2e-6, moment[k], 1e-5 * moment.norm());
    contact.set_rotation(rest);
  }
}

// Body and tool turned and carried together: what does not touch still gives no force, and a stuck contact the same
// one.
TEST_P(ContactOfTool, MovedAsARigidBodyWithTheBodyItGivesNoNewForce) {
  const Case c = make(GetParam());
  const mesh::TetMesh mesh = test::block_mesh({0, 0.5, 1}, {0, 0.5, 1}, {0, 1});
  const std::vector<char> fixed(mesh.nodes.size(), 0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity(), motion = pose;
  motion.linear() = Eigen::AngleAxisd(1.3, Vector3d(-1, 0.4, 2).normalized()).toRotationMatrix();
  motion.translation() = Vector3d(2, -3, 0.7);
  const auto carried = [&](const VectorXd& x) {
    VectorXd y(x.size());
    for (Eigen::Index n = 0; n < x.size() / 3; ++n) y.segment<3>(3 * n) = motion * Vector3d(x.segment<3>(3 * n));
    return y;
  };
  const auto contact_at = [&](const Eigen::Isometry3d& at) {
    solve::ContactEnergy contact(mesh, fixed, *c.shape, at);
    contact.set_penalty(1e4);
    contact.set_anchor_stiffness(5e3);
    return contact;
  };
  VectorXd x = test::stacked(mesh);
  pose.translation() = c.at;
  solve::ContactEnergy here = contact_at(pose);
  // Lifted until it touches and no more, a nanometre off.
  for (int k = 0; k < 100 && here.gap(x) < 1e-9; ++k) {
    pose.translation().z() += 1e-9 - here.gap(x);
    here.set_translation(pose.translation());
  }
  ASSERT_NEAR(here.gap(x), 1e-9, 1e-10);
  const solve::ContactReport apart = contact_at(motion * pose).report(carried(x));
  EXPECT_EQ(apart.force.norm(), 0.0);
  EXPECT_EQ(apart.points, 0U);

  pose.translation() = c.at;
  here.set_translation(c.at);
  here.stick(x);
  for (Eigen::Index k = 0; k < x.size(); ++k) x[k] += 0.01 * std::sin(3.0 * static_cast<double>(k));
  solve::ContactEnergy there = contact_at(motion * pose);
  there.set_anchors(here.anchors());
  const solve::ContactReport before = here.report(x), after = there.report(carried(x));
  ASSERT_GT(before.force.norm(), 1.0);
  EXPECT_GT(before.tangential_energy, 0.0);
  EXPECT_LT((after.force - motion.linear() * before.force).norm(), 1e-11 * before.force.norm());
  EXPECT_NEAR(there.value(carried(x)), here.value(x), 1e-12 * here.value(x));
}

INSTANTIATE_TEST_SUITE_P(Tools, ContactOfTool, ::testing::Range(0, 4));

TEST(Contact, UniformOverlapOfAFlatPunchIsPressureTimesArea) {
  const mesh::TetMesh mesh = test::block_mesh({0, 0.5, 1}, {0, 0.5, 1}, {0, 1});
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Vector3d(0.5, 0.5, 1 - 0.01);
  const auto punch = tool::make_punch(3.0, 0.3, 4.0);  // covers the whole face
  solve::ContactEnergy contact(mesh, std::vector<char>(mesh.nodes.size(), 0), *punch, pose);
  contact.set_penalty(1e4);
  const solve::ContactReport r = contact.report(test::stacked(mesh));
  EXPECT_NEAR(r.force.z(), 1e4 * 0.01, 1e-9);
  EXPECT_NEAR(r.area, 1.0, 1e-12);
  EXPECT_NEAR(r.penetration, 0.01, 1e-12);
  EXPECT_NEAR(contact.slip_ratio(test::stacked(mesh), Vector3d::UnitX(), Vector3d::UnitZ()), 1.0, 1e-12);
}

}  // namespace
}  // namespace palpate::fem
