// SPDX-License-Identifier: GPL-3.0-or-later
// A tool that moves as a rigid body with the body feels nothing new: contact and friction of a ball, a cone and a
// closed mesh.
#include "precompute/solve/contact/friction.hpp"
#include "precompute/tool/mesh_shape.hpp"
#include "precompute/tool/shapes.hpp"
#include "precompute/tool/taper.hpp"
#include "tests/support/block_mesh.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace palpate::solve {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

struct Touching {
  std::shared_ptr<const tool::ToolShape> shape;
  Vector3d at;  // in the top of the block
};

Touching touching(int k) {
  switch (k) {
    case 0:
      return {tool::make_sphere(0.5), {0.31, 0.42, 1.37}};
    case 1:
      return {tool::make_taper(0.05, 1.2, 0.6, 2.0), {0.33, 0.41, 0.95}};
    default:
      return {std::make_shared<tool::MeshShape>(test::box_surface({-0.4, -0.4, 0}, {0.4, 0.4, 0.8}), 0.1),
              {0.45, 0.52, 1.0}};
  }
}

class RigidMotion : public ::testing::TestWithParam<int> {
protected:
  const Touching tool_ = touching(GetParam());
  const mesh::TetMesh mesh_ = test::block_mesh({0, 0.5, 1}, {0, 0.5, 1}, {0, 1});
  const VectorXd rest_ = test::stacked(mesh_);
  Isometry3d pose_ = Isometry3d::Identity(), motion_ = pose_;

  void SetUp() override {
    pose_.linear() = Eigen::AngleAxisd(0.3, Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
    pose_.translation() = tool_.at;
    motion_.linear() = Eigen::AngleAxisd(1.3, Vector3d(-1, 0.4, 2).normalized()).toRotationMatrix();
    motion_.translation() = Vector3d(2, -3, 0.7);
  }
  [[nodiscard]] ContactEnergy contact_at(const Isometry3d& pose) const {
    ContactEnergy contact(mesh_, std::vector<char>(mesh_.nodes.size(), 0), *tool_.shape, pose);
    contact.set_penalty(1e4);
    contact.set_anchor_stiffness(5e3);
    return contact;
  }
  static void move(ContactEnergy& contact, const Isometry3d& pose) {
    contact.set_rotation(pose.linear());
    contact.set_translation(pose.translation());
  }
  [[nodiscard]] VectorXd carried(const VectorXd& x) const {
    VectorXd y(x.size());
    for (Eigen::Index n = 0; n < x.size() / 3; ++n) y.segment<3>(3 * n) = motion_ * Vector3d(x.segment<3>(3 * n));
    return y;
  }
  [[nodiscard]] VectorXd deformed(double by) const {
    VectorXd x = rest_;
    for (Eigen::Index k = 0; k < x.size(); ++k) x[k] += by * std::sin(3.0 * static_cast<double>(k));
    return x;
  }
};

TEST_P(RigidMotion, AToolThatOnlyTouchesFeelsNoForce) {
  ContactEnergy contact = contact_at(pose_);
  // Lifted until it is a nanometre off.
  for (int k = 0; k < 200 && contact.gap(rest_) < 1e-9; ++k) {
    contact.set_translation(contact.translation() + Vector3d(0, 0, 1e-9 - contact.gap(rest_)));
  }
  ASSERT_NEAR(contact.gap(rest_), 1e-9, 1e-10);
  move(contact, motion_ * contact.pose());
  EXPECT_EQ(contact.report(carried(rest_)).points, 0U);
  EXPECT_EQ(contact.report(carried(rest_)).force.norm(), 0.0);
  EXPECT_NEAR(contact.gap(carried(rest_)), 1e-9, 1e-12);
}

TEST_P(RigidMotion, AStuckContactIsShearedNoMore) {
  ContactEnergy contact = contact_at(pose_);
  contact.stick(rest_);
  const ContactReport unsheared = contact.report(rest_);
  ASSERT_GT(unsheared.points, 10U);
  const VectorXd x = deformed(0.01);
  const ContactReport sheared = contact.report(x);
  ASSERT_GT(sheared.tangential_energy, 1e-3 * sheared.normal_energy);
  move(contact, motion_ * pose_);
  const ContactReport still = contact.report(carried(rest_)), after = contact.report(carried(x));
  EXPECT_LT(still.tangential_energy, 1e-20 * still.normal_energy);
  EXPECT_LT((still.force - motion_.linear() * unsheared.force).norm(), 1e-11 * unsheared.force.norm());
  EXPECT_LT((after.force - motion_.linear() * sheared.force).norm(), 1e-11 * sheared.force.norm());
  EXPECT_LT((after.moment - motion_.linear() * sheared.moment).norm(), 1e-11 * sheared.moment.norm());
  EXPECT_NEAR(after.tangential_energy / sheared.tangential_energy, 1, 1e-11);
}

TEST_P(RigidMotion, FrictionTurnsWithTheBodyAndDissipatesNothing) {
  ContactEnergy contact = contact_at(pose_);
  FrictionEnergy friction(contact, 0.4, 2e4);
  friction.begin(rest_);
  move(contact, motion_ * pose_);
  friction.hold(carried(rest_));
  const FrictionReport unsheared = friction.report(carried(rest_));
  ASSERT_GT(unsheared.pressure, 1.0);
  EXPECT_LT(unsheared.traction, 1e-11 * unsheared.limit);
  EXPECT_LT(friction.settle(carried(rest_)), 1e-14 * unsheared.limit);

  // A step in which a part of the contact slips, then the motion back.
  const VectorXd x = deformed(0.003);
  Isometry3d aside = pose_;
  aside.translation() += Vector3d(0.01, 0.003, 0);
  friction.begin(carried(rest_));
  move(contact, motion_ * aside);
  friction.hold(carried(x));
  const double slid = friction.settle(carried(x));
  const FrictionReport before = friction.report(carried(x));
  const Vector3d about(0.5, 0.5, 1), moment = friction.moment(carried(x), motion_ * about);
  ASSERT_GT(slid, 0.0);
  friction.begin(carried(x));
  move(contact, aside);
  friction.hold(x);
  EXPECT_LT(friction.settle(x), 1e-11 * slid);
  const FrictionReport after = friction.report(x);
  ASSERT_GT(before.traction, 0.1 * before.limit);
  EXPECT_LT((motion_.linear() * after.force - before.force).norm(), 1e-11 * before.force.norm());
  EXPECT_LT((motion_.linear() * friction.moment(x, about) - moment).norm(), 1e-11 * moment.norm());
  EXPECT_NEAR(after.stored / before.stored, 1, 1e-11);
}

// Places of points, slips and dissipation are given in the tool's frame: a motion of both within the step changes none
// of them.
TEST_P(RigidMotion, AStepSlipsAlikeWhereBodyAndToolTurnInIt) {
  Isometry3d start = pose_, end = pose_;
  start.translation() += Vector3d(-0.02, 0, 0.04);
  const VectorXd x = deformed(0.003);
  const auto step = [&](const Isometry3d& pose, const VectorXd& to, double& dissipated) {
    ContactEnergy contact = contact_at(start);
    FrictionEnergy friction(contact, 0.4, 2e4);
    friction.begin(rest_);
    const std::size_t begun = contact.touching(rest_).size();
    move(contact, pose);
    EXPECT_GT(contact.touching(to).size(), begun + 5);  // that land
    friction.hold(to);
    dissipated = friction.settle(to);
    return friction.report(to);
  };
  double straight = 0, turned = 0;
  const FrictionReport a = step(end, x, straight), b = step(motion_ * end, carried(x), turned);
  ASSERT_GT(straight, 0.0);
  ASSERT_GT(a.force.norm(), 0.0);
  EXPECT_LT((b.force - motion_.linear() * a.force).norm(), 1e-11 * a.force.norm());
  EXPECT_NEAR(turned / straight, 1, 1e-11);
  EXPECT_NEAR(b.stored / a.stored, 1, 1e-11);
}

INSTANTIATE_TEST_SUITE_P(Tools, RigidMotion, ::testing::Range(0, 3), [](const auto& k) {
  return std::string(k.param == 0 ? "Ball" : k.param == 1 ? "Cone" : "Mesh");
});

}  // namespace
}  // namespace palpate::solve
