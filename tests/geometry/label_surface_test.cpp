// SPDX-License-Identifier: GPL-3.0-or-later
// The surface round a ball's voxels against the ball: closed, of the voxels' volume, nearer with smaller voxels.
#include "precompute/geometry/label_surface.hpp"

#include "formats/io/error.hpp"
#include "tests/support/label_ball.hpp"
#include "tests/support/shapes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <numbers>

namespace palpate::geometry {
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

// Height differences over 2 mm against the ball's own: what a small tip takes for a step.
double steps_felt(const Surface& s) {
  std::vector<double> steps;
  for (std::size_t a = 0; a < s.vertices.size(); a += 997) {
    for (std::size_t b = 0; b < s.vertices.size(); ++b) {
      const double apart = (s.vertices[a] - s.vertices[b]).norm();
      if (apart < 0.0015 || apart > 0.0025) continue;
      steps.push_back(std::abs(s.vertices[a].norm() - s.vertices[b].norm()));
    }
  }
  std::sort(steps.begin(), steps.end());
  return steps[steps.size() * 95 / 100];
}

// A ball of 30 mm in slices of 3 mm, and of 5 mm, along turned axes.
TEST(LabelSurface, ThickSlicesLeaveNoSteps) {
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(0.3, Vector3d::UnitX()) * Eigen::AngleAxisd(0.5, Vector3d::UnitZ())).toRotationMatrix();
  for (const double slice : {3.0}) {
    constexpr double radius = 0.03;
    LabelMask mask;
    mask.axes = turn * Vector3d(0.8e-3, 0.8e-3, slice * 1e-3).asDiagonal();
    mask.size = {80, 80, int(66 / slice)};
    mask.origin = -mask.axes * Vector3d(39.7, 39.6, 33 / slice - 0.4);
    for (int k = 0; k < mask.size[2]; ++k) {
      for (int j = 0; j < mask.size[1]; ++j) {
        for (int i = 0; i < mask.size[0]; ++i) {
          const bool in = (mask.origin + mask.axes * Vector3d(i, j, k)).norm() < radius;
          mask.inside.push_back(in ? 1 : 0);
          mask.count += in ? 1 : 0;
        }
      }
    }
    const Surface s = label_surface(mask, "ball");
    EXPECT_TRUE(test::closed_and_oriented(s));
    EXPECT_NEAR(test::surface_volume(s) / (double(mask.count) * mask.axes.determinant()), 1, 1e-3);
    double square = 0, furthest = 0;
    for (const Vector3d& v : s.vertices) {
      square += std::pow(v.norm() - radius, 2) / double(s.vertices.size());
      furthest = std::max(furthest, std::abs(v.norm() - radius));
    }
    std::printf(
        "slices %g mm: %zu triangles, radius off by rms %.3f mm, most %.3f mm, step over 2 mm (95 %%) %.3f mm\n", slice,
        s.triangles.size(), 1e3 * std::sqrt(square), 1e3 * furthest, 1e3 * steps_felt(s));
    EXPECT_LT(std::sqrt(square), 0.2e-3);
    EXPECT_LT(steps_felt(s), 0.3e-3);
  }
}

// Any axes are possible: slanted, mirrored and of different lengths.
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
}  // namespace palpate::geometry
