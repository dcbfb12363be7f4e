// SPDX-License-Identifier: GPL-3.0-or-later
// Tangential pushes of a contact that sticks, through the entry point that the bake uses.
#include "tests/support/press.hpp"

#include <gtest/gtest.h>

namespace palpate::solve {
namespace {

// A second push, to twice the depth aside, peels in both directions. Together they take no more factorisations than the
// normal indentation and the pushes that hold.
TEST(StickingPushes, ThosePeelingCostNoMoreThanThoseThatHold) {
  const Body body = test::block_body(0.03, 5e3, 0.3);
  Scene scene;
  scene.friction = 1;
  scene.solver.mesh_size = 0.9;
  PairPath path = bake_path(scene, 0.002);
  path.normal_depths = {0.0005, 0.001, 0.002};
  path.tangential_depths = {0.002};
  path.tangential_directions = 2;
  path.tangential_points = 1;
  path.tangential_reach = 1;
  const PairResult held = test::press(body, ToolScene{}, path, pair_options(scene));
  ASSERT_TRUE(held.outcome.accepted) << held.outcome.cause;
  EXPECT_EQ(held.outcome.cause, "");
  ASSERT_EQ(held.samples.size(), 3U + 2U);
  path.tangential_points = 2;
  path.tangential_reach = 2;
  const PairResult peeled = test::press(body, ToolScene{}, path, pair_options(scene));
  ASSERT_TRUE(peeled.outcome.accepted) << peeled.outcome.cause;
  EXPECT_NE(peeled.outcome.cause.find("the contact peels"), std::string::npos) << peeled.outcome.cause;
  ASSERT_EQ(peeled.samples.size(), held.samples.size());
  for (std::size_t k = 0; k < held.samples.size(); ++k) {
    EXPECT_LT((peeled.samples[k].force - held.samples[k].force).norm(), 0.01 * held.samples[k].force.norm());
  }
  EXPECT_LE(peeled.outcome.factorisations, 2 * held.outcome.factorisations);
}

}  // namespace
}  // namespace palpate::solve
