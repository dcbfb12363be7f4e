// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors, tensors of a tangent plane, poses, rotation vectors.
#include <cmath>
#include <limits>
#include <numbers>

#include "palpate/math/rotation.hpp"
#include "palpate/math/vec2.hpp"
#include "tests/runtime/support.hpp"

namespace palpate::pose_test {
namespace {

using namespace test;
using runtime::rotation_pose;
using runtime::rotation_vector;
using runtime::Sym2;
using runtime::Vec2;

Pose random_pose(std::mt19937& random, double angle) {
  const Vec3 axis = random_direction(random), at = random_direction(random);
  return turned(angle * std::uniform_real_distribution<double>(-1, 1)(random), axis, at);
}

TEST(Pose, ProductsAndInversesComposeMotions) {
  std::mt19937 random(31);
  for (int i = 0; i < 200; ++i) {
    const Pose a = random_pose(random, 3), b = random_pose(random, 3);
    const Vec3 p = random_direction(random);
    EXPECT_LT(distance((a * b).apply(p), a.apply(b.apply(p))), 1e-14);
    EXPECT_LT(distance(inverse(a).apply(a.apply(p)), p), 1e-14);
    EXPECT_LT(distance(a.unapply(a.apply(p)), p), 1e-14);
    EXPECT_LT(distance(a.unrotate(a.rotate(p)), p), 1e-14);
    EXPECT_TRUE((a * inverse(b)).valid());
    EXPECT_TRUE(a == a);
    EXPECT_FALSE(a == b);
  }
}

TEST(Pose, FromAxisHasThatAxisForEveryDirection) {
  std::mt19937 random(32);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 special[] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
    Vec3 axis = i < 4 ? special[i] : random_direction(random);
    if (i % 5 == 4) axis = unit(Vec3{1e-7 * axis.x, 1e-7 * axis.y, i % 2 == 0 ? 1.0 : -1.0}, {});
    const Pose pose = Pose::from_axis({1, 2, 3}, axis);
    EXPECT_TRUE(pose.valid()) << axis.x << ' ' << axis.y << ' ' << axis.z;
    EXPECT_LT(distance(pose.axis(), axis), 1e-12);
    EXPECT_LT(distance(pose.rotate({0, 0, 1}), axis), 1e-12);
    EXPECT_EQ(distance(pose.translation, {1, 2, 3}), 0);
  }
}

TEST(Pose, FromQuaternionOfAnyLengthIsARotation) {
  for (const double size : {1e-3, 1.0, 40.0}) {
    const Pose pose = Pose::from_quaternion(0.5 * size, -size, 0.3 * size, 0.1 * size, {});
    EXPECT_TRUE(pose.valid());
    EXPECT_LT(distance(pose.rotate({1, 0, 0}), Pose::from_quaternion(0.5, -1, 0.3, 0.1, {}).rotate({1, 0, 0})), 1e-14);
  }
}

TEST(Pose, InvalidNumbersAreNoPose) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  const Pose wrong[] = {upright({kNan, 0, 0}), upright({0, kInf, 0}), upright({0, 0, 2e6}),
                        {{kNan, 0, 0, 0, 1, 0, 0, 0, 1}, {}}, {{2, 0, 0, 0, 1, 0, 0, 0, 1}, {}},
                        {{-1, 0, 0, 0, 1, 0, 0, 0, 1}, {}}, {{}, {}}, Pose::from_quaternion(0, 0, 0, 0, {}),
                        Pose::from_quaternion(kNan, 0, 0, 1, {})};
  for (const Pose& pose : wrong) EXPECT_FALSE(pose.valid()) << &pose - wrong;
  EXPECT_TRUE(upright({-9e5, 0, 9e5}).valid());
}

TEST(Pose, OrthonormalRemovesWhatAValidPoseMayBeOff) {
  std::mt19937 random(33);
  std::uniform_real_distribution<double> off(-2e-4, 2e-4);
  for (int i = 0; i < 200; ++i) {
    Pose pose = random_pose(random, 3);
    for (double& r : pose.rotation) r += off(random);
    if (!pose.valid()) continue;
    const Pose good = orthonormal(pose);
    const Pose identity = good * inverse(good);
    for (int k = 0; k < 9; ++k) EXPECT_NEAR(identity.rotation[k], k % 4 == 0 ? 1 : 0, 1e-14);
    EXPECT_LT(distance(good.rotate({1, 2, 3}), pose.rotate({1, 2, 3})), 5e-3);
  }
}

TEST(Pose, TravelBoundsTheWayOfEveryPointOfATool) {
  std::mt19937 random(34);
  for (int i = 0; i < 500; ++i) {
    const Pose from = random_pose(random, 3), to = random_pose(random, 0.1) * from;
    const double radius = 0.1;
    for (int k = 0; k < 20; ++k) {
      const Vec3 p = radius * random_direction(random);
      EXPECT_LE(distance(from.apply(p), to.apply(p)), travel(from, to, radius) * (1 + 1e-12));
    }
  }
  EXPECT_EQ(travel(upright({}), upright({3, 4, 0}), 1), 5);
}

TEST(Pose, BetweenGoesFromOnePoseToTheOther) {
  std::mt19937 random(35);
  for (int i = 0; i < 100; ++i) {
    const Pose from = random_pose(random, 3), to = random_pose(random, 1) * from;
    EXPECT_LT(travel(between(from, to, 0), from, 1), 1e-13);
    EXPECT_LT(travel(between(from, to, 1), to, 1), 1e-13);
    double way = 0;
    Pose last = from;
    for (int k = 1; k <= 20; ++k) {
      const Pose pose = between(from, to, k / 20.0);
      EXPECT_TRUE(pose.valid());
      way = std::max(way, travel(last, pose, 0.1));
      last = pose;
    }
    EXPECT_LT(way, 3 * travel(from, to, 0.1) / 20);
  }
}

TEST(Rotation, VectorAndPoseAreInverse) {
  std::mt19937 random(36);
  for (int i = 0; i < 500; ++i) {
    const double angle = i % 10 == 0 ? std::numbers::pi - 1e-9 * i : std::numbers::pi * (i / 500.0);
    const Vec3 v = angle * random_direction(random);
    EXPECT_LT(distance(rotation_vector(rotation_pose(v).rotation), v), 1e-7) << angle;
  }
  EXPECT_EQ(length(rotation_vector(Pose().rotation)), 0);
  const Vec3 small{1e-5, -2e-5, 3e-5};
  EXPECT_LT(distance(small_rotation(rotation_pose(small)), small), 1e-13);
}

TEST(Vec3, TurnedIsTheSmallestRotation) {
  std::mt19937 random(37);
  for (int i = 0; i < 500; ++i) {
    const Vec3 from = random_direction(random), to = random_direction(random), v = random_direction(random);
    if (dot(from, to) < -0.99) continue;
    EXPECT_LT(distance(runtime::turned(from, from, to), to), 1e-12);
    EXPECT_NEAR(length(runtime::turned(v, from, to)), 1, 1e-11);
    const Vec3 axis = cross(from, to);
    EXPECT_LT(distance(runtime::turned(axis, from, to), axis), 1e-11);
  }
}

TEST(Vec3, AnyOrthogonalIsAUnitVectorAcross) {
  std::mt19937 random(38);
  for (int i = 0; i < 500; ++i) {
    const Vec3 n = i == 0 ? Vec3{0, 0, -1} : i == 1 ? Vec3{0, 0, 1} : random_direction(random);
    EXPECT_NEAR(dot(runtime::any_orthogonal(n), n), 0, 1e-14);
    EXPECT_NEAR(length(runtime::any_orthogonal(n)), 1, 1e-14);
  }
}

TEST(Sym2, SolveInvertsAPositiveTensor) {
  std::mt19937 random(39);
  std::uniform_real_distribution<double> draw(-1, 1);
  for (int i = 0; i < 500; ++i) {
    const double m = 1 + draw(random) * 0.5, share = 0.99 * std::fabs(draw(random)), angle = 3 * draw(random);
    const Sym2 k{m, share * m * std::cos(angle), share * m * std::sin(angle)};
    const Vec2 u{draw(random), draw(random)}, back = solve(k, k * u);
    EXPECT_NEAR(back.x, u.x, 1e-12);
    EXPECT_NEAR(back.y, u.y, 1e-12);
    EXPECT_GE(quadratic(k, u), 0);
  }
}

TEST(Sym2, SolveOfATensorThatResistsAlongALineUsesThatLine) {
  const Vec2 v{0.6, 0.8}, across{-0.8, 0.6};
  const double m = 2.5;  // 2 m v v
  const Sym2 k{m, m * (v.x * v.x - v.y * v.y), 2 * m * v.x * v.y};
  const Vec2 u = solve(k, 5.0 * v + 3.0 * across);
  EXPECT_NEAR(u.x, v.x, 1e-12);
  EXPECT_NEAR(u.y, v.y, 1e-12);
  EXPECT_EQ(length(solve(Sym2{}, v)), 0);
  EXPECT_EQ(length(solve(Sym2{-1, 0, 0}, v)), 0);
}

}  // namespace
}  // namespace palpate::pose_test
