// SPDX-License-Identifier: GPL-3.0-or-later
// The surface round a ball's voxels against the ball: closed, of the voxels' volume, nearer with smaller voxels.
#include "precompute/geometry/label_surface.hpp"

#include "formats/error.hpp"
#include "tests/support/label_ball.hpp"
#include "tests/support/shapes.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace palpate {
namespace {

using Eigen::Vector3d;

const Vector3d centre(0.02, -0.01, 0.03);
constexpr double kRadius = 0.008, kBall = 4.0 / 3 * std::numbers::pi * kRadius * kRadius * kRadius;

TEST(LabelSurface, OfABallLiesCloseToIt) {
  for (const double voxels : {4.0, 8.0, 16.0}) {
    const double voxel = kRadius / voxels;
    const LabelMask mask = test::label_ball(centre, kRadius, voxel);
    const Surface s = label_surface(mask, "ball");
    EXPECT_TRUE(test::closed_and_oriented(s));
    EXPECT_EQ(s.parts.size(), s.triangles.size());
    EXPECT_NEAR(test::surface_volume(s) / (double(mask.count) * voxel * voxel * voxel), 1, 1e-3);
    EXPECT_NEAR(test::surface_volume(s) / kBall, 1, 0.4 / voxels);
    double furthest = 0;
    for (const Vector3d& v : s.vertices) furthest = std::max(furthest, std::abs((v - centre).norm() - kRadius));
    EXPECT_LT(furthest, 0.35 * voxel) << voxels;
  }
}

// What the axes are does not matter: slanted, mirrored and of different lengths.
TEST(LabelSurface, FollowsTheAxesOfItsVoxels) {
  LabelMask mask = test::label_ball({0, 0, 0}, 1, 0.125);
  mask.axes = 0.125 * (Eigen::Matrix3d() << 2, 0.3, 0, 0, -1, 0.2, 0.1, 0, 0.5).finished();
  const Surface s = label_surface(mask, "slanted");
  EXPECT_TRUE(test::closed_and_oriented(s));
  EXPECT_NEAR(test::surface_volume(s) / (double(mask.count) * std::abs(mask.axes.determinant())), 1, 1e-3);
}

TEST(LabelSurface, AtTheImagesBorderAndInTwoParts) {
  LabelMask mask;
  mask.size = {12, 5, 5};
  mask.axes.setIdentity();
  for (int row = 0; row < 25; ++row) {
    for (int i = 0; i < 12; ++i) mask.inside.push_back(i < 4 || i > 7 ? 1 : 0);
  }
  for (const auto in : mask.inside) mask.count += in;
  const Surface s = label_surface(mask, "two");
  EXPECT_TRUE(test::closed_and_oriented(s));
  EXPECT_NEAR(test::surface_volume(s), 200, 0.2);
}

TEST(LabelSurface, TooThinIsRefused) {
  LabelMask mask;
  mask.size = {9, 9, 1};
  mask.axes.setIdentity();
  mask.inside.assign(81, 0);
  mask.inside[40] = 1;
  mask.count = 1;
  try {
    label_surface(mask, "dot");
    FAIL() << "one voxel has no surface";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_NE(std::string(error.what()).find("dot: its 1 voxels are too thin"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace palpate
