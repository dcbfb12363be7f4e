// SPDX-License-Identifier: GPL-3.0-or-later
// Tangential pushes from stick to slip, through the entry point that the bake uses.
#include "precompute/solve/push/coulomb_push.hpp"
#include "tests/support/press.hpp"

#include <gtest/gtest.h>

namespace palpate::solve::slipping_pushes_test {
namespace {

constexpr double kYoung = 5e3, kPoisson = 0.49;

// A path with slipping pushes has the same other samples as one without. On a deep contact the solved limit exceeds the
// one predicted from the slopes of the normal indentation, which exceeds mu: tissue piles up before the tool.
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
  const double predicted = plain.samples[2].friction_limit;
  for (std::size_t k = plain.samples.size(); k < more.samples.size(); ++k) {
    const Sample& s = more.samples[k];
    EXPECT_EQ(s.kind, SampleKind::slipping);
    EXPECT_EQ(s.index, k - plain.samples.size());
    EXPECT_EQ(s.friction_limit > 0, s.index % 2 == 1);
    if (s.index % 2 == 1) {
      EXPECT_NEAR(s.friction_limit / predicted, 1.15, 0.15);
    }
  }
}

// A scene with a solved friction limit has, at the deepest push, a third more than is predicted, as a long slide has
// it, from every direction, and the curve from stick to slip before it.
TEST(SlippingPushes, ASceneGetsItsFrictionLimitSolved) {
  Scene scene;
  scene.friction = 0.3;
  scene.sampling.normal_points = 6;
  scene.sampling.friction_limit = SamplingScene::FrictionLimit::solved;
  scene.solver.mesh_size = 0.25;  // by 0.35 the limit scatters by 4 % with the mesh
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
}  // namespace palpate::solve::slipping_pushes_test
