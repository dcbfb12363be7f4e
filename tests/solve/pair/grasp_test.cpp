// SPDX-License-Identifier: GPL-3.0-or-later
// A grasped contact against the closed forms of a bonded punch, and as the continuation of the push that formed it.
#include "tests/support/press.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace palpate::solve::grasp_test {
namespace {

constexpr double kYoung = 5e3;

std::vector<Sample> grasped(const PairResult& r) {
  std::vector<Sample> samples;
  for (const Sample& s : r.samples) {
    if (s.kind == SampleKind::grasped) samples.push_back(s);
  }
  return samples;
}

// Spence 1968: P = 4 G a ln(3 - 4 nu) / (1 - 2 nu) d, 2 E* a d where nu is a half.
class BondedPunch : public ::testing::TestWithParam<double> {
protected:
  const double nu = GetParam(), radius = 0.005, depth = 0.005 * radius, shear = kYoung / (2 * (1 + nu));
  ToolScene punch;
  PairPath path;
  PairOptions options;

  void SetUp() override {
    punch.shape = ToolScene::Shape::punch;
    punch.radius = radius;
    punch.edge_radius = 0.002 * radius;
    path.normal_depths = {0.5 * depth, depth};
    path.friction = 1.0;
    path.grasp_depth = depth;
    path.grasp_depths = {-depth, -0.5 * depth, 0};
  }
};

// The first step finds its contact without friction: the punch's own frictionless stiffness on the same mesh.
TEST_P(BondedPunch, IsPulledAsStiffAsSpenceSays) {
  const PairResult r = test::press(test::block_body(40 * radius, kYoung, nu), punch, path, options);
  ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
  const std::vector<Sample> pulled = grasped(r);
  ASSERT_EQ(pulled.size(), 4U);
  EXPECT_EQ(r.outcome.cause, "");
  EXPECT_EQ(pulled[0].force, r.samples[1].force);
  const double spence = std::log(3 - 4 * nu) / (1 - 2 * nu), sneddon = 1 / (1 - nu);
  const double free = r.samples[0].force.z() / r.samples[0].deflection.z();
  for (std::size_t k = 1; k < pulled.size(); ++k) {
    const double stiffness =
        (pulled[0].force.z() - pulled[k].force.z()) / (pulled[0].deflection.z() - pulled[k].deflection.z());
    EXPECT_NEAR(stiffness / (4 * shear * radius * spence), 1.0, 0.03) << "depth " << pulled[k].deflection.z();
    EXPECT_NEAR(stiffness / free / (spence / sneddon), 1.0, 0.01);
  }
  EXPECT_LT(pulled.back().force.z(), -0.9 * r.samples[1].force.z());
}

INSTANTIATE_TEST_SUITE_P(Poisson, BondedPunch, ::testing::Values(0.3, 0.49));

// A deep grasp by a sphere: through the origin into a pull, without a step, and alike to all sides.
TEST(GraspedSphere, GoesOnFromThePushIntoAPull) {
  PairPath path;
  path.normal_depths = {0.001, 0.002, 0.003};
  path.friction = 0.3;
  path.grasp_depth = 0.002;
  path.grasp_depths = {-0.002, -0.001, 0, 0.001, 0.003};
  path.grasp_directions = 2;
  path.grasp_points = 2;
  path.grasp_reach = 0.001;
  const PairResult r = test::press(test::block_body(0.03, kYoung, 0.49), ToolScene{}, path, {});
  ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
  EXPECT_EQ(r.outcome.cause, "");
  std::vector<Sample> normal, aside;
  for (const Sample& s : grasped(r)) (s.deflection.head<2>().norm() > 1e-4 ? aside : normal).push_back(s);
  ASSERT_EQ(normal.size(), 6U);
  ASSERT_EQ(aside.size(), 3U * 4U);
  EXPECT_EQ(normal[0].force, r.samples[1].force);
  std::sort(normal.begin(), normal.end(),
            [](const Sample& a, const Sample& b) { return a.deflection.z() < b.deflection.z(); });
  EXPECT_LT(normal.front().force.z(), 0);
  for (std::size_t k = 1; k < normal.size(); ++k) {
    EXPECT_GT(normal[k].force.z(), normal[k - 1].force.z());
  }
  // Bonds that formed on the way remain as the push goes deeper; the push alone is a little softer.
  EXPECT_NEAR(normal.back().force.z() / r.samples[2].force.z(), 1.0, 0.03);
  for (std::size_t k = 0; k < aside.size(); k += 4) {
    EXPECT_LT(aside[k + 1].force.x(), 0);
    EXPECT_NEAR(aside[k + 1].force.x() / -aside[k + 3].force.x(), 1.0, 0.05);
    EXPECT_NEAR(aside[k + 1].force.x() / aside[k].force.x(), 2.0, 0.3);
  }
}

}  // namespace
}  // namespace palpate::solve::grasp_test
