// SPDX-License-Identifier: GPL-3.0-or-later
// Slip softening from pushes with a known softening.
#include "precompute/fit/laws/slip_softening.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::fit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kScale = 0.003, kCoulomb = 0.3, kPushed = 300, kAside = 180;  // N/m^1.5

// A round tip on a thick body.
Vector3d sticking(const Vector3d& at) {
  const double root = std::sqrt(at.z());
  return {-kAside * root * at.x(), -kAside * root * at.y(), kPushed * root * at.z()};
}
double held(double depth) { return kCoulomb * kPushed * depth / kAside; }

// How the normal force is another where the tool comes to: by the way over the depth, and by its square.
struct Course {
  Vector2d slope{0, 0};
  double bend = 0;
};

// Normal pushes, and pushes that slip in three directions.
std::vector<Sample> samples_of(double softening, const Course& course = {}, double deepest = kScale) {
  std::vector<Sample> samples;
  for (const double share : {0.25, 0.5, 0.75, 1.0}) {
    const double depth = share * share * deepest;
    Sample normal;
    normal.deflection = {0, 0, depth};
    normal.force = sticking(normal.deflection);
    normal.friction_limit = kCoulomb;
    samples.push_back(normal);
    for (int d = 0; d < 3; ++d) {
      const double angle = 2 * M_PI * d / 3;
      const Vector2d u(std::cos(angle), std::sin(angle));
      for (const double moved : {0.8, 1.2, 1.6, 2.4}) {
        const double way = std::max(0.0, moved - 1) * held(depth);
        const Vector2d went = way / depth * u;
        Sample s;
        s.kind = SampleKind::slipping;
        s.deflection << moved * held(depth) * u, depth;
        s.force =
            sticking({std::min(moved, 1.0) * held(depth) * u.x(), std::min(moved, 1.0) * held(depth) * u.y(), depth});
        s.force.z() *= (1 - (moved > 1 ? softening * depth / kScale : 0)) * (1 + course.slope.dot(went) + course.bend * went.squaredNorm());
        s.friction_limit = moved > 1 ? kCoulomb : 0;
        samples.push_back(s);
      }
    }
  }
  return samples;
}

TEST(SlipSoftening, IsFoundAgain) {
  for (const double softening : {0.0, 0.004, 0.03}) {
    EXPECT_NEAR(slip_softening(samples_of(softening), sticking, kScale), softening, 0.02 * softening + 1e-9) << softening;
  }
  EXPECT_NEAR(slip_softening(samples_of(0.03, {}, 0.5 * kScale), sticking, kScale), 0.03, 1e-3) << "half as deep";
}

// A body that is harder to one side, or all round, where the tool slides to.
TEST(SlipSoftening, IsToldApartFromWhereTheToolComesTo) {
  for (const Course& course : {Course{{0.1, -0.2}, 0}, Course{{0, 0}, -0.2}, Course{{0.15, 0.1}, 0.1}}) {
    EXPECT_NEAR(slip_softening(samples_of(0.02, course), sticking, kScale), 0.02, 2e-3);
  }
}

TEST(SlipSoftening, IsNoneWhereNothingTells) {
  EXPECT_EQ(slip_softening({}, sticking, kScale), 0);
  std::vector<Sample> few = samples_of(0.02);
  std::erase_if(few, [](const Sample& s) { return s.kind == SampleKind::slipping; });
  EXPECT_EQ(slip_softening(few, sticking, kScale), 0);
  std::vector<Sample> one_way = samples_of(0.02);
  std::erase_if(one_way, [](const Sample& s) { return s.kind == SampleKind::slipping && s.deflection.y() != 0; });
  EXPECT_EQ(slip_softening(one_way, sticking, kScale), 0) << "the direction is not determined";
}

// The slipping contact pushes more than the sticking one. No softening models that, and the runtime would gain energy.
TEST(SlipSoftening, IsNotNegative) {
  std::vector<Sample> more = samples_of(0);
  for (Sample& s : more) {
    if (s.kind == SampleKind::slipping) s.force.z() *= 1.05;
  }
  EXPECT_EQ(slip_softening(more, sticking, kScale), 0);
}

// A tool that slides off a margin loses most of its force, and that is no relief.
TEST(SlipSoftening, IsNoneAtAMargin) {
  for (const double bend : {-0.8, -2.0}) EXPECT_EQ(slip_softening(samples_of(0.02, {{0, 0}, bend}), sticking, kScale), 0);
  std::vector<Sample> less = samples_of(0.02);
  for (Sample& s : less) {
    if (s.kind == SampleKind::slipping && s.deflection.z() < 0.5 * kScale) s.force.z() *= 0.8;
  }
  EXPECT_LT(slip_softening(less, sticking, kScale), 0.031) << "shallow pushes that say far more than deep ones";
}

}  // namespace
}  // namespace palpate::fit
