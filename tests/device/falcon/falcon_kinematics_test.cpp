// SPDX-License-Identifier: GPL-3.0-or-later
// The Falcon's arms: against the published half-angle formula, finite differences, energy and themselves.
#include "device/falcon/falcon_kinematics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "tests/device/seeded.hpp"

namespace palpate::device::falcon {
namespace {

using test::Seeded;

constexpr double kDegree = 0.017453292519943295;

double volume(const Arms& arms) { return dot(arms.arm[0].pull, cross(arms.arm[1].pull, arms.arm[2].pull)); }

double shortest_lever(const Arms& arms) { return std::min({arms.arm[0].lever, arms.arm[1].lever, arms.arm[2].lever}); }

// Places within `radius` of the middle that the arms reach the way they are assembled.
void over_workspace(double radius, int places, const std::function<void(const Vec3&, const Arms&, Seeded&)>& visit) {
  Seeded random(1);
  for (int i = 0; i < places;) {
    const Vec3 tip = kCentre + radius * random.in_ball();
    const Arms arms = inverse(tip);
    if (!arms.reached || volume(arms) > -1e-3) continue;
    visit(tip, arms, random);
    ++i;
  }
}

// The reference's own form, word for word: half angle, row of the Jacobian.
struct Published {
  double angle;
  Vec3 row;
};
Published published(const Vec3& tip, double degrees) {
  const double a = 0.060, b = 0.1025, c = 0.01443, d = 0.01125, e = 0.01125, f = -0.025, r = 0.040, s = -0.02309;
  const double cp = std::cos(degrees * kDegree), sp = std::sin(degrees * kDegree);
  const double u = cp * tip.x + sp * tip.y - r, v = -sp * tip.x + cp * tip.y - s, w = tip.z;
  const double theta3 = std::acos((v + f) / b), length = d + e + b * std::sin(theta3);
  const double k = (u + c) * (u + c) + w * w + a * a - length * length;
  const double first = k + 2 * a * (u + c), last = k - 2 * a * (u + c);
  const double t = (4 * a * w - std::sqrt(16 * a * a * w * w - 4 * first * last)) / (2 * first);
  const double theta1 = 2 * std::atan(t);
  const double c2 = (u + c - a * std::cos(theta1)) / length, s2 = (w - a * std::sin(theta1)) / length;
  const double s3 = std::sin(theta3), c3 = std::cos(theta3);
  const double below = -a * s3 * std::sin(theta1 - std::atan2(s2, c2));
  return {theta1, (1 / below) * Vec3{cp * c2 * s3 - sp * c3, sp * c2 * s3 + cp * c3, s2 * s3}};
}

TEST(FalconKinematics, InverseIsThePublishedHalfAngle) {
  const double degrees[] = {105, -15, -135};
  over_workspace(0.05, 2000, [&](const Vec3& tip, const Arms& arms, Seeded&) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Published other = published(tip, degrees[i]);
      // The published form cancels for a nearly straight arm.
      if (arms.arm[i].lever < 1e-3) continue;
      EXPECT_NEAR(arms.arm[i].angle, other.angle, 1e-9);
      EXPECT_LT(length(gradient(arms.arm[i]) - other.row), 1e-8 * length(other.row));
    }
  });
}

TEST(FalconKinematics, GradientIsThatOfFiniteDifferences) {
  constexpr double kStep = 1e-6;
  double worst = 0;
  over_workspace(0.05, 2000, [&](const Vec3& tip, const Arms& arms, Seeded&) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (arms.arm[i].lever < 0.02) continue;  // near a straight arm a difference of finite step has no meaning
      const Vec3 row = gradient(arms.arm[i]);
      const auto slope = [&](const Vec3& way) {
        return (inverse(tip + kStep * way).arm[i].angle - inverse(tip - kStep * way).arm[i].angle) / (2 * kStep);
      };
      const Vec3 differences{slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
      worst = std::max(worst, length(row - differences) / length(row));
    }
  });
  EXPECT_LT(worst, 1e-7);
}

TEST(FalconKinematics, RoundTripFromAnyStart) {
  double worst = 0, straightest = 1;
  int steps = 0;
  over_workspace(0.06, 20000, [&](const Vec3& tip, const Arms& arms, Seeded& random) {
    straightest = std::min(straightest, shortest_lever(arms));
    const Reached reached = forward(arms.angles(), kCentre + 0.06 * random.in_ball());
    ASSERT_TRUE(reached.ok) << tip.x << ' ' << tip.y << ' ' << tip.z;
    worst = std::max(worst, length(reached.tip - tip));
    steps = std::max(steps, reached.steps);
  });
  EXPECT_LT(worst, 1e-9);
  EXPECT_LT(straightest, 2e-3);  // poses with an arm nearly straight were among them
  EXPECT_LE(steps, 40);
}

TEST(FalconKinematics, RoundTripFromTheLastPlace) {
  double worst = 0;
  int steps = 0;
  over_workspace(0.06, 20000, [&](const Vec3& tip, const Arms& arms, Seeded& random) {
    const Reached reached = forward(arms.angles(), tip + 0.002 * random.in_ball());
    ASSERT_TRUE(reached.ok);
    worst = std::max(worst, length(reached.tip - tip));
    steps = std::max(steps, reached.steps);
  });
  EXPECT_LT(worst, 1e-9);
  EXPECT_LE(steps, 5);
}

// Straight up to where an arm is straight: the angle's gradient has no bound there, the place is found all the same.
TEST(FalconKinematics, RoundTripAtTheEndOfReach) {
  Seeded random(2);
  int straight = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 way = unit(random.in_ball(), {0, 0, 1});
    double inside = 0, outside = 0.06;
    for (int k = 0; k < 60; ++k) {
      const double half = (inside + outside) / 2;
      const Arms arms = inverse(kCentre + half * way);
      (arms.reached && volume(arms) < -0.02 ? inside : outside) = half;
    }
    const Vec3 tip = kCentre + inside * way;
    const Arms arms = inverse(tip);
    ASSERT_TRUE(arms.reached);
    straight += shortest_lever(arms) < 1e-6;
    const Reached reached = forward(arms.angles(), tip - 0.001 * way);
    ASSERT_TRUE(reached.ok) << "after " << inside << " m";
    // At a lever of 0 the angle itself is good to the root of what its cosine is: 1e-8 rad, on no lever.
    EXPECT_LT(length(reached.tip - tip), 1e-9);
  }
  EXPECT_GT(straight, 50);
}

TEST(FalconKinematics, PlacesThatNoAnglesHaveAreRefused) {
  // Any angles: what is found has them, with the knees as built.
  Seeded random(3);
  int found = 0;
  for (int i = 0; i < 20000; ++i) {
    const Triple angles{random.between(-3.2, 3.2), random.between(-3.2, 3.2), random.between(-3.2, 3.2)};
    const Reached reached = forward(angles, kCentre + 0.3 * random.in_ball());
    ASSERT_TRUE(std::isfinite(length(reached.tip)));
    if (!reached.ok) continue;
    const Arms arms = inverse(reached.tip);
    if (!arms.reached) continue;  // an arm is straight, to rounding
    ++found;
    EXPECT_LT(volume(arms), 0);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(std::cos(arms.arm[k].angle - angles[k]), 1, 1e-9);
  }
  EXPECT_GT(found, 1000);
  EXPECT_FALSE(inverse({0, 0, 0.25}).reached);
  EXPECT_FALSE(inverse({0.3, 0, 0.1}).reached);
  EXPECT_FALSE(inverse({0, 0, -0.1}).reached);
  const double nan = std::numeric_limits<double>::quiet_NaN(), huge = std::numeric_limits<double>::max();
  EXPECT_FALSE(inverse({nan, 0, 0.15}).reached);
  EXPECT_FALSE(inverse({0, 0, huge}).reached);
  EXPECT_FALSE(forward({nan, 0, 0}, kCentre).ok);
  // A start that is no place is left for the middle.
  const Arms arms = inverse({0.01, 0.02, 0.14});
  EXPECT_TRUE(forward(arms.angles(), {nan, nan, nan}).ok);
  EXPECT_TRUE(forward(arms.angles(), {9e9, -9e9, 9e9}).ok);
}

// Virtual work: a displacement dx of the hand against the force takes the work that the motors do.
TEST(FalconStatics, TorquesDoTheWorkOfTheForce) {
  over_workspace(0.05, 2000, [&](const Vec3& tip, const Arms& arms, Seeded& random) {
    if (shortest_lever(arms) < 0.01 || volume(arms) > -0.05) return;
    const Vec3 force = 8 * random.in_ball();
    const Triple torque = torques(arms, force);
    const Vec3 way = 1e-6 * random.in_ball();
    const Triple before = inverse(tip - way).angles(), after = inverse(tip + way).angles();
    double work = 0;
    for (std::size_t i = 0; i < 3; ++i) work += torque[i] * (after[i] - before[i]);
    EXPECT_NEAR(work / 2e-6, dot(force, way) / 1e-6, 1e-5);
  });
}

// The torques of a force, converted back into a force, keep its direction.
TEST(FalconStatics, MotorsKeepTheForcesDirectionAndNeverWrap) {
  int limited = 0;
  over_workspace(0.06, 5000, [&](const Vec3&, const Arms& arms, Seeded& random) {
    const Vec3 force = std::pow(10.0, random.between(-1, 9)) * unit(random.in_ball(), {1, 0, 0});
    const auto counts = motors(torques(arms, force));
    int most = 0;
    for (const int count : counts) most = std::max(most, std::abs(count));
    ASSERT_LE(most, kMostCounts);
    limited += most == kMostCounts;
    if (shortest_lever(arms) < 0.01 || most < kMostCounts) return;
    Vec3 held;
    for (std::size_t i = 0; i < 3; ++i) held = held + (-1e-4 * counts[i] / arms.arm[i].lever) * arms.arm[i].pull;
    // Rounding to a count turns it by a few counts of 4096.
    EXPECT_LT(length(unit(held, {}) - unit(force, {})), 4e-3);
  });
  EXPECT_GT(limited, 1000);
  const double infinite = std::numeric_limits<double>::infinity();
  const std::array<std::int16_t, 3> none{};
  EXPECT_EQ(motors({0.1, infinite, 0}), none);
  EXPECT_EQ(motors({0.1, std::nan(""), 0}), none);
  EXPECT_EQ(motors({1e300, 0, -1e300}), (std::array<std::int16_t, 3>{-4096, 0, 4096}));
  EXPECT_EQ(motors({0.01, -0.02, 0}), (std::array<std::int16_t, 3>{-100, 200, 0}));
}

TEST(FalconStatics, AnArmThatPushesUpPushesTheGripOut) {
  const Arms arms = inverse(kCentre);
  const Triple torque = torques(arms, {0, 0, 3});
  for (const double one : torque) EXPECT_NEAR(one, torque[0], 1e-12);  // the three arms are alike
  EXPECT_GT(torque[0], 0);
}

TEST(FalconEncoders, AnglesAndCounts) {
  EXPECT_NEAR(angle_of(0), 35 * kDegree, 1e-15);
  EXPECT_NEAR(angle_of(1000), (35 + 36.4347) * kDegree, 1e-12);
  for (const int encoder : {-32768, -1000, -1, 0, 1, 500, 32767}) {
    EXPECT_EQ(encoder_of(angle_of(static_cast<std::int16_t>(encoder))), encoder);
  }
  EXPECT_EQ(encoder_of(1e9), 32767);
  EXPECT_EQ(encoder_of(-1e9), -32768);
}

}  // namespace
}  // namespace palpate::device::falcon
