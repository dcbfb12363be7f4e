// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms of partial and full slip, through the entry point that the bake uses.
#include "precompute/solve/coulomb_push.hpp"
#include "tests/solve/two_domains.hpp"
#include "tests/support/press.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace palpate::slip_laws_test {
namespace {

constexpr double kYoung = 5e3, kPoisson = 0.49;

// The contact is formed without friction and then pushed sideways at its depth: at nu = 0.49 pressures hardly change.
// The tractions that slip relieves at the rim are not singular, and need no ring of small elements.
// Two pushes of four points, the last of each in full slip, over the law; the normal load stays what it was.
std::vector<double> over_cattaneo_mindlin(double size, double mesh_size) {
  const double radius = 0.01, depth = 0.001 * radius, a = std::sqrt(radius * depth), mu = 0.3;
  PairPath path;
  path.normal_depths = {0.25 * depth, 0.5 * depth, 0.75 * depth, depth};
  path.tangential_depths = {depth};
  path.tangential_directions = 2;
  path.tangential_points = 0;
  path.friction = mu;
  path.form_frictionless = true;
  path.slip_points = 4;
  path.slip_reach = 1.2 * gross_slip_reach(mu, kPoisson);
  PairOptions options;
  options.mesh_size = mesh_size;
  ToolScene sphere;
  sphere.radius = radius;
  const PairResult r = test::press(test::block_body(size * a, kYoung, kPoisson), sphere, path, options);
  EXPECT_TRUE(r.outcome.accepted) << r.outcome.cause;
  EXPECT_EQ(r.outcome.cause, "");
  const double shear = kYoung / (2 * (1 + kPoisson));
  double load = 0;
  std::vector<double> over_law;
  for (const Sample& s : r.samples) {
    if (s.kind == SampleKind::normal) load = s.force.z();
    if (s.kind != SampleKind::slipping) continue;
    const double limit = mu * s.force.z(), q = s.force.head<2>().norm();
    const double furthest = 3 * limit * (2 - kPoisson) / (16 * shear * a);
    const double share = s.deflection.head<2>().norm() / furthest;
    const double expected = share < 1 ? 1 - std::pow(1 - share, 1.5) : 1.0;
    over_law.push_back(q / limit / expected);
    EXPECT_NEAR(s.force.z() / load, 1.0, 0.01) << share;
    EXPECT_EQ(s.friction_limit > 0, share > 1) << share;
    EXPECT_EQ(s.index % 4 == 3, share > 1) << share;
  }
  EXPECT_EQ(over_law.size(), 8U);
  return over_law;
}

double slip_tolerance(std::size_t k) { return k % 4 == 3 ? 0.02 : 0.05; }

TEST(CattaneoMindlin, PartialSlipThenFullSlip) {
  const std::vector<double> over_law = over_cattaneo_mindlin(60, 0.2);
  for (std::size_t k = 0; k < over_law.size(); ++k) EXPECT_NEAR(over_law[k], 1.0, slip_tolerance(k)) << k;
}

TEST(LongCattaneoMindlin, TwoBlocks) {
  const test::TwoDomains two =
      test::on_two_domains(30, 60, [](double size) { return over_cattaneo_mindlin(size, 0.12); });
  for (std::size_t k = 0; k < two.endless.size(); ++k) test::expect_law(two, k, slip_tolerance(k));
}

// A path that asks for slipping pushes as well gets the samples that it would get without. On a deep contact the solved
// limit passes the one foretold from the slopes of the straight push, which passes mu: tissue piles up before the tool.
TEST(SlippingPushes, ChangeNothingElse) {
  const Body body = test::block_body(0.03, kYoung, kPoisson);
  Scene scene;
  scene.friction = 0.3;
  scene.solver.mesh_size = 0.5;
  const ToolScene sphere;
  PairPath path = bake_path(scene, 0.004);
  path.normal_depths = {0.001, 0.0025, 0.004};
  path.tangential_depths = {0.004};
  path.tangential_directions = 2;
  path.tangential_points = 1;
  const PairResult plain = test::press(body, sphere, path, pair_options(scene));
  path.slip_points = 2;
  path.slip_reach = 1.3 * gross_slip_reach(scene.friction, kPoisson);
  const PairResult more = test::press(body, sphere, path, pair_options(scene));
  ASSERT_TRUE(more.outcome.accepted) << more.outcome.cause;
  ASSERT_EQ(plain.samples.size(), 3U + 2U);
  ASSERT_EQ(more.samples.size(), plain.samples.size() + 2U * 2U);
  for (std::size_t k = 0; k < plain.samples.size(); ++k) {
    EXPECT_EQ(more.samples[k].force, plain.samples[k].force);
    EXPECT_EQ(more.samples[k].deflection, plain.samples[k].deflection);
  }
  const double foretold = plain.samples[2].friction_limit;
  for (std::size_t k = plain.samples.size(); k < more.samples.size(); ++k) {
    const Sample& s = more.samples[k];
    EXPECT_EQ(s.kind, SampleKind::slipping);
    EXPECT_EQ(s.index, k - plain.samples.size());
    EXPECT_EQ(s.friction_limit > 0, s.index % 2 == 1);
    if (s.index % 2 == 1) {
      EXPECT_NEAR(s.friction_limit / foretold, 1.15, 0.15);
    }
  }
}

// What a scene that wants its friction limit solved gets: of the deepest push a third more than is foretold, as a long
// slide has it, from every direction, and the curve from stick to slip before it.
TEST(SlippingPushes, ASceneGetsItsFrictionLimitSolved) {
  Scene scene;
  scene.friction = 0.3;
  scene.sampling.normal_points = 6;
  scene.sampling.friction_limit = SamplingScene::FrictionLimit::solved;
  PairPath path = bake_path(scene, 0.005);
  path.tangential_depths = {path.tangential_depths.back()};
  path.tangential_points = 1;
  const PairResult r = test::press(test::block_body(0.03, kYoung, kPoisson), ToolScene{}, path, pair_options(scene));
  ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
  EXPECT_EQ(r.outcome.cause, "");
  const Sample& deepest = r.samples[5];
  ASSERT_EQ(deepest.kind, SampleKind::normal);
  int slid = 0, partial = 0;
  for (const Sample& s : r.samples) {
    if (s.kind != SampleKind::slipping || s.deflection.z() != deepest.deflection.z()) continue;
    partial += s.friction_limit > 0 ? 0 : 1;
    if (s.index % 3 != 2) continue;
    EXPECT_NEAR(s.friction_limit / 0.465, 1.0, 0.03);
    ++slid;
  }
  EXPECT_EQ(slid, 3);
  EXPECT_GE(partial, 3);
  EXPECT_NEAR(deepest.friction_limit / 0.345, 1.0, 0.02);
}

}  // namespace
}  // namespace palpate::slip_laws_test
