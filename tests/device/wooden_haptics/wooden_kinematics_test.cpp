// SPDX-License-Identifier: GPL-3.0-or-later
// The WoodenHaptics arm against finite differences, its inverse and virtual work, near its singular poses too.
#include "device/wooden_haptics/wooden_kinematics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace palpate::device {
namespace {

using runtime::Vec3;

constexpr double kPi = 3.141592653589793;

// Poses all over, and close to where B + C is 0 or pi, and to the column's axis.
std::vector<Joints> poses() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<Joints> result;
  for (int k = 0; k < 2000; ++k) {
    const double b = 0.5 * kPi * any(random), bent = 0.5 * kPi * (1 + any(random));
    result.push_back({kPi * any(random), b, bent - b});
    const double near = std::pow(10.0, -1 - k % 12);
    result.push_back({any(random), b, near - b});
    result.push_back({any(random), b, kPi - near - b});
    result.push_back({any(random), near, near});
  }
  result.push_back({0, 0, 0});
  result.push_back({0, 0, kPi / 2});
  return result;
}

TEST(WoodenKinematics, JacobianIsTheDerivative) {
  const WoodenGeometry g;
  constexpr double kStep = 1e-5;
  for (const Joints& q : poses()) {
    const auto j = jacobian(g, q);
    for (std::size_t k = 0; k < 3; ++k) {
      Joints more = q, less = q;
      more[k] += kStep;
      less[k] -= kStep;
      const Vec3 difference = (1 / (2 * kStep)) * (position(g, more) - position(g, less));
      ASSERT_LT(length(difference - j[k]), 1e-10) << q[0] << " " << q[1] << " " << q[2];
    }
  }
}

TEST(WoodenKinematics, ReachesEveryPositionThatItHas) {
  const WoodenGeometry g;
  double worst = 0;
  for (const Joints& q : poses()) {
    const Vec3 at = position(g, q);
    Joints found{};
    ASSERT_TRUE(reach(g, at, found)) << q[0] << " " << q[1] << " " << q[2];
    worst = std::fmax(worst, length(position(g, found) - at));
    ASSERT_GE(found[1] + found[2], -1e-12);
    ASSERT_LE(found[1] + found[2], kPi + 1e-12);
  }
  EXPECT_LT(worst, 1e-9);
}

TEST(WoodenKinematics, AnglesComeBackAwayFromSingularPoses) {
  const WoodenGeometry g;
  for (const Joints& q : poses()) {
    const double radius = g.upper * std::sin(q[1]) + g.lower * std::sin(q[2]), bent = q[1] + q[2];
    if (radius < 0.02 || bent < 0.1 || bent > kPi - 0.1) continue;
    Joints found{};
    ASSERT_TRUE(reach(g, position(g, q), found));
    for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(found[k], q[k], 1e-9);
  }
}

TEST(WoodenKinematics, BeyondReachIsRefused) {
  const WoodenGeometry g;
  Joints q{1, 2, 3};
  const double far = g.upper + g.lower, near = g.lower - g.upper;
  const Vec3 shoulder = Vec3{0, 0, g.column} - g.origin;
  EXPECT_FALSE(reach(g, shoulder + Vec3{far + 1e-9, 0, 0}, q));
  EXPECT_FALSE(reach(g, shoulder + Vec3{0, 0, near - 1e-9}, q));
  EXPECT_FALSE(reach(g, {std::nan(""), 0, 0}, q));
  EXPECT_FALSE(reach(g, {std::numeric_limits<double>::infinity(), 0, 0}, q));
  EXPECT_EQ(q, (Joints{1, 2, 3}));
  EXPECT_TRUE(reach(g, shoulder + Vec3{far, 0, 0}, q));
  EXPECT_TRUE(reach(g, shoulder + Vec3{0, 0, near}, q));
}

// The torques of the published table, by its own formulas.
TEST(WoodenKinematics, CurrentsGiveTheForce) {
  WoodenGeometry g;
  g.sign = {1, -1, 1};
  const Vec3 f{1.5, -0.7, 2.1};
  for (const Joints& q : poses()) {
    const double rho = g.upper * std::sin(q[1]) + g.lower * std::sin(q[2]);
    const double ca = std::cos(q[0]), sa = std::sin(q[0]);
    const double torque[3] = {-sa * rho * f.x + ca * rho * f.y,
                              g.upper * (ca * std::cos(q[1]) * f.x + sa * std::cos(q[1]) * f.y - std::sin(q[1]) * f.z),
                              g.lower * (ca * std::cos(q[2]) * f.x + sa * std::cos(q[2]) * f.y + std::sin(q[2]) * f.z)};
    const Joints amps = currents(g, q, f);
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_NEAR(amps[k], g.sign[k] * torque[k] * g.capstan[k] / g.body[k] / 0.0259, 1e-12);
    }
  }
}

TEST(WoodenKinematics, CountsAndAnglesAreEachOthersInverse) {
  const WoodenGeometry g;
  // A quarter turn of the lower body: 12 motor turns for one of the body, 2000 counts each.
  EXPECT_NEAR(counts(g, {0, 0, kPi / 2})[2], 6000, 1e-9);
  const Joints back = angles(g, counts(g, {0.1, -0.2, 0.3}));
  EXPECT_NEAR(back[0], 0.1, 1e-15);
  EXPECT_NEAR(back[1], -0.2, 1e-15);
  EXPECT_NEAR(back[2], 0.3, 1e-15);
}

TEST(WoodenGeometry, SaysWhatIsWrong) {
  EXPECT_EQ(WoodenGeometry{}.validate(), nullptr);
  const auto wrong = [](auto change) {
    WoodenGeometry g;
    change(g);
    return g.validate() != nullptr;
  };
  EXPECT_TRUE(wrong([](WoodenGeometry& g) { g.upper = 0; }));
  EXPECT_TRUE(wrong([](WoodenGeometry& g) { g.body[1] = -1; }));
  EXPECT_TRUE(wrong([](WoodenGeometry& g) { g.sign[2] = 0; }));
  EXPECT_TRUE(wrong([](WoodenGeometry& g) { g.counts = std::nan(""); }));
  EXPECT_TRUE(wrong([](WoodenGeometry& g) { g.torque_constant = 0; }));
  EXPECT_TRUE(wrong([](WoodenGeometry& g) { g.origin.x = std::nan(""); }));
}

}  // namespace
}  // namespace palpate::device
