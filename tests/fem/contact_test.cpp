// SPDX-License-Identifier: GPL-3.0-or-later
// Contact energy: derivatives of every tool and of the anchors, and the forces that it reports.
#include "precompute/solve/contact.hpp"

#include "precompute/tool/shapes.hpp"
#include "tests/support/block_mesh.hpp"
#include "tests/support/finite_difference.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

class ContactProblem final : public EnergyProblem {
public:
  explicit ContactProblem(const ContactEnergy& c) : c_(c) {}
  double value(const VectorXd& x) const override { return c_.value(x); }
  double gradient(const VectorXd& x, VectorXd& g) const override {
    g.setZero();
    return c_.gradient(x, g);
  }
  void hessian(const VectorXd& x, HessianKind kind, BlockMatrix& m) const override { c_.hessian(x, kind, m); }
  double load(const VectorXd&) const override { return 1.0; }

private:
  const ContactEnergy& c_;
};

struct Case {
  const char* name;
  std::shared_ptr<const ToolShape> shape;
  Vector3d at;
};

class ContactOfTool : public ::testing::TestWithParam<int> {
protected:
  static Case make(int k) {
    switch (k) {
      case 0:
        return {"sphere", make_sphere(0.5), {0.31, 0.42, 1.37}};
      case 1:
        return {"capsule tip", make_capsule(0.4, 1.0), {0.33, 0.41, 1.29}};
      case 2:
        return {"punch", make_punch(0.45, 0.1, 1.0), {0.33, 0.41, 0.93}};
      default:
        return {"capsule stem", make_capsule(0.3, 2.0), {0.31, 0.42, 0.2}};
    }
  }
};

TEST_P(ContactOfTool, DerivativesMatchDifferences) {
  const Case c = make(GetParam());
  const TetMesh mesh = test::block_mesh({0, 0.5, 1}, {0, 0.5, 1}, {0, 1});
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(0.3, Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
  pose.translation() = c.at;
  ContactEnergy contact(mesh, std::vector<char>(mesh.nodes.size(), 0), *c.shape, pose);
  contact.set_penalty(1e4);
  contact.set_anchor_stiffness(5e3);
  VectorXd x = test::stacked(mesh);
  ASSERT_GT(contact.report(x).points, 0u) << c.name;
  const ContactProblem problem(contact);
  EXPECT_LT(test::gradient_error(problem, x, 1e-6), 1e-5) << c.name;
  EXPECT_LT(test::hessian_error(problem, mesh, x, 1e-7), 1e-4) << c.name;

  contact.stick(x);
  for (Eigen::Index k = 0; k < x.size(); ++k) x[k] += 0.01 * std::sin(3.0 * static_cast<double>(k));
  EXPECT_GT(contact.report(x).tangential_energy, 0.0);
  EXPECT_LT(test::gradient_error(problem, x, 1e-6), 1e-5) << c.name << " anchored";
  EXPECT_LT(test::hessian_error(problem, mesh, x, 1e-7), 1e-4) << c.name << " anchored";

  // The reported force is the derivative of the energy along the tool's motion.
  const Vector3d at = contact.translation(), force = contact.report(x).force;
  for (int k = 0; k < 3; ++k) {
    contact.set_translation(at + 1e-6 * Vector3d::Unit(k));
    const double up = contact.value(x);
    contact.set_translation(at - 1e-6 * Vector3d::Unit(k));
    const double down = contact.value(x);
    EXPECT_NEAR(-(up - down) / 2e-6, force[k], 1e-5 * force.norm());
  }
}
INSTANTIATE_TEST_SUITE_P(Tools, ContactOfTool, ::testing::Range(0, 4));

TEST(Contact, UniformOverlapOfAFlatPunchIsPressureTimesArea) {
  const TetMesh mesh = test::block_mesh({0, 0.5, 1}, {0, 0.5, 1}, {0, 1});
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Vector3d(0.5, 0.5, 1 - 0.01);
  const auto punch = make_punch(3.0, 0.3, 4.0);  // covers the whole face
  ContactEnergy contact(mesh, std::vector<char>(mesh.nodes.size(), 0), *punch, pose);
  contact.set_penalty(1e4);
  const ContactReport r = contact.report(test::stacked(mesh));
  EXPECT_NEAR(r.force.z(), 1e4 * 0.01, 1e-9);
  EXPECT_NEAR(r.area, 1.0, 1e-12);
  EXPECT_NEAR(r.penetration, 0.01, 1e-12);
  EXPECT_NEAR(contact.slip_ratio(test::stacked(mesh), Vector3d::UnitX(), Vector3d::UnitZ()), 1.0, 1e-12);
}

}  // namespace
}  // namespace palpate
