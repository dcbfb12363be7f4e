// SPDX-License-Identifier: GPL-3.0-or-later
// Self-convergence at large strain: one push on three meshes whose whole size fields fall by the root of 2, through the
// entry point that the bake uses, with the laws as scenes select them.
#include "precompute/solve/pair/contact_size.hpp"
#include "precompute/solve/pair/sample_difference.hpp"
#include "tests/support/laws.hpp"
#include "tests/support/press.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>
#include <string>

namespace palpate::solve {
namespace {

using std::numbers::sqrt2;

struct Pushed {
  const char* name;
  ToolScene::Shape shape;
  MaterialScene::Law law;
  double scatter;  // of the force between meshes, below which differences need not fall
  friend void PrintTo(const Pushed& pushed, std::ostream* out) { *out << pushed.name; }
};

// Into a block of 8 x 8 x 4 tip radii, a sphere or a punch whose rim is rounded by a fifth, to 40 % of its radius.
class SelfConvergence : public ::testing::TestWithParam<Pushed> {
protected:
  static constexpr double kRadius = 0.005, kDepth = 0.4 * kRadius;
  Body body_ = test::block_body(4 * kRadius, 5e3, 0.45);
  tool::Tool tool_;

  void SetUp() override {
    body_.material = test::law_scene(GetParam().law, 0.45);
    body_.material.young = small_strain_young(body_.material);
    ToolScene tool;
    tool.shape = GetParam().shape;
    tool.radius = kRadius;
    if (tool.shape == ToolScene::Shape::punch) tool.edge_radius = kRadius / 5;
    tool_ = tool::make_tool(tool);
  }

  // N, with the settings' elements times `factor` in the whole body.
  [[nodiscard]] double force(double factor) const {
    PairOptions options;
    options.refine = factor;
    options.growth *= factor;
    options.max_size = longest_edge(body_, options) * std::sqrt(factor);  // contact_size takes the root as well
    PairPath path;
    path.normal_depths = {0.5 * kDepth, kDepth};
    const tool::ToolVertex& tip = tool_.vertices[0];
    const PairResult r = solve_pair({body_, tool_, tip, ContactFrame{}}, path, options);
    EXPECT_TRUE(r.outcome.accepted) << r.outcome.cause;
    // Every way that a failed push is tried again has a finer mesh.
    const mesh::SizeField size = contact_size({body_, tool_, tip, ContactFrame{}}, kDepth, factor, options);
    EXPECT_EQ(r.outcome.nodes, mesh::mesh_volume(body_, size, {ContactFrame{}.origin}).mesh.nodes.size());
    return r.samples.size() == 2 ? force_at(r.samples[1], r.samples[0], kDepth).z() : std::nan("");
  }
};

TEST_P(SelfConvergence, ThreeMeshesFallTowardsOneForce) {
  const double coarse = force(sqrt2), base = force(1.0), fine = force(1 / sqrt2);
  const double first = (base - coarse) / fine, second = (fine - base) / fine;
  EXPECT_TRUE(std::abs(second) < std::abs(first) / sqrt2 ||
              std::max(std::abs(first), std::abs(second)) < GetParam().scatter)
      << first << ' ' << second;
  // Richardson's limit of the order seen, if it is 1 or more, and of order 1.
  for (const double gain : {std::max(std::abs(first / second), sqrt2), sqrt2}) {
    EXPECT_NEAR(base / (fine * (1 + second / (gain - 1))), 1, 0.02) << first << ' ' << second << ' ' << gain;
  }
}

constexpr auto kSphere = ToolScene::Shape::sphere, kPunch = ToolScene::Shape::punch;
constexpr auto kNeoHookean = MaterialScene::Law::neo_hookean, kMooneyRivlin = MaterialScene::Law::mooney_rivlin;

const auto push_name = [](const auto& c) { return std::string(c.param.name); };
INSTANTIATE_TEST_SUITE_P(Quick, SelfConvergence,
                         ::testing::Values(Pushed{"SphereNeoHookean", kSphere, kNeoHookean, 0.003}), push_name);
// The last one's differences are -0.49 and 0.36 %, then, with elements half as long, 0.24 %: order 0.8.
INSTANTIATE_TEST_SUITE_P(Long, SelfConvergence,
                         ::testing::Values(Pushed{"SphereMooneyRivlin", kSphere, kMooneyRivlin, 0.003},
                                           Pushed{"PunchNeoHookean", kPunch, kNeoHookean, 0.003},
                                           Pushed{"PunchMooneyRivlin", kPunch, kMooneyRivlin, 0.005}),
                         push_name);

}  // namespace
}  // namespace palpate::solve
