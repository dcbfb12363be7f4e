// SPDX-License-Identifier: GPL-3.0-or-later
// Held-out solves on a box: where tangential pushes go, and how the threads end.
#include "precompute/verify/held_out/held_out.hpp"

#include "formats/io/error.hpp"
#include "precompute/mesh/surface/remesh.hpp"
#include "precompute/verify/held_out/statistics.hpp"
#include "tests/support/response_samples.hpp"
#include "tests/support/shapes.hpp"

#include <gtest/gtest.h>

#include "palpate/format/open.hpp"

#include <atomic>
#include <stdexcept>

namespace palpate::verify {
namespace {

// The box of the sample response files, soft, pressed in the middle of its top, solved as coarsely as is allowed.
class HeldOutSolves : public testing::Test {
protected:
  void SetUp() override {
    const double half = test::kBoxSize / 2, top = test::kBoxSize / 4;
    const Surface surface = test::box_surface({-half, -half, -top}, {half, half, top});
    body_.query = std::make_shared<const geometry::SurfaceQuery>(surface);
    body_.base_size = 0.008;
    body_.base = mesh::remesh_uniform(surface, body_.base_size);
    body_.diagonal = 3 * half;
    SupportScene bottom;
    bottom.kind = SupportScene::Kind::half_space;
    bottom.point = {0, 0, -0.999 * top};
    body_.supports.push_back(bottom);
    body_.support_surfaces.emplace_back();
    scene_.sampling.depth = 0.002;
    scene_.sampling.normal_points = 4;
    scene_.sampling.within_box = {{-0.01, -0.01, 0.9 * top}, {0.01, 0.01, 1.1 * top}};
    scene_.solver.mesh_size = 0.7;
    options_.count = 1;
  }

  HeldOutSet solve(ToolScene::Shape shape, test::ResponseSampleOptions::Tools record) {
    test::ResponseSampleOptions sample;
    sample.tools = record;
    sample.bonded = grasp_depth_ > 0;
    sample.bonded_torque = grasp_turn_ > 0;
    bytes_ = encode(test::box_content(sample));
    const runtime::OpenResult opened = runtime::View::open(bytes_.data(), bytes_.size());
    ToolScene tool;
    tool.shape = shape;
    tool.radius = test::kTipRadius;
    tool.length = test::kStemLength;
    tool.grasp_depth = grasp_depth_;
    tool.grasp_turn = grasp_turn_;
    return solve_held_out(opened.view, scene_, body_, {tool::make_tool(tool)}, options_);
  }

  Body body_;
  Scene scene_;
  HeldOutOptions options_;
  double grasp_depth_ = 0.0, grasp_turn_ = 0.0;
  std::vector<std::byte> bytes_;
};

// A capsule is not symmetric about its normal: pushes along x alone would never compare what was baked along y.
TEST_F(HeldOutSolves, AToolThatMustKeepItsSpinIsPushedObliquely) {
  scene_.friction = 0.3;
  // A contact near the tip: the sample's tool has few patches, the first reaches from the tip to 45 degrees.
  options_.touchable = [](const solve::ContactCase& contact, double) {
    return contact.vertex.meridian < 0.9 * test::kTipRadius;
  };
  options_.count = 2;
  const HeldOutSet set = solve(ToolScene::Shape::capsule, test::ResponseSampleOptions::Tools::capsule);
  std::size_t oblique = 0;
  for (const HeldOut& contact : set.contacts) {
    ASSERT_TRUE(contact.accepted) << contact.cause;
    for (const ForcePair& f : contact.forces) {
      if (f.kind != SampleKind::tangential) continue;
      const double x = std::abs(f.deflection.dot(contact.frame.x)), y = std::abs(f.deflection.dot(contact.frame.y));
      oblique += std::min(x, y) > 0.02 * std::max(x, y) ? 1 : 0;
    }
  }
  EXPECT_GE(oblique, 6u);
}

TEST_F(HeldOutSolves, ErrorsOfForcesBelowTheFloorAreSharesOfIt) {
  scene_.response.floor = 1e3;  // N
  const HeldOutSet set = solve(ToolScene::Shape::sphere, test::ResponseSampleOptions::Tools::sphere);
  ASSERT_TRUE(set.contacts[0].accepted) << set.contacts[0].cause;
  ASSERT_FALSE(set.contacts[0].forces.empty());
  for (const ForcePair& f : set.contacts[0].forces) {
    EXPECT_DOUBLE_EQ(f.error, (f.baked - f.solved).norm() / scene_.response.floor);
  }
}

TEST_F(HeldOutSolves, AToolThatHoldsOnIsPulledAndTurnedToo) {
  grasp_depth_ = 0.001;
  grasp_turn_ = 0.2;
  const HeldOutSet set = solve(ToolScene::Shape::sphere, test::ResponseSampleOptions::Tools::sphere);
  ASSERT_TRUE(set.contacts[0].accepted) << set.contacts[0].cause;
  int out = 0, aside = 0, turned = 0;
  for (const ForcePair& f : set.contacts[0].forces) {
    if (f.kind != SampleKind::grasped) continue;
    const Eigen::Vector3d& n = set.contacts[0].frame.n;
    const double depth = -f.deflection.dot(n);
    out += depth < -5e-4 && f.solved.dot(n) < 0 && f.baked.dot(n) < 0 ? 1 : 0;
    aside += (f.deflection + depth * n).norm() > 5e-4 ? 1 : 0;
    if (!f.turn) continue;
    ++turned;
    EXPECT_LE(f.turn->rotation.norm(), 0.14 + 1e-12);
    EXPECT_GE(f.turn->rotation.norm(), 0.125);
    // Each turn is about no axis of the bake.
    EXPECT_LT(f.turn->rotation.normalized().cwiseAbs().maxCoeff(), 0.999);
    EXPECT_LT(f.turn->solved.dot(f.turn->rotation), 0);
    EXPECT_LT(f.turn->baked.dot(f.turn->rotation), 0);
  }
  EXPECT_GE(turned, 6);
  EXPECT_EQ(summarise(set.contacts).turned.count, static_cast<std::size_t>(turned));
  EXPECT_GE(out, 1);
  EXPECT_GE(aside, 3);
}

TEST_F(HeldOutSolves, AnExceptionEndsEveryThreadAndIsRethrown) {
  options_.count = 24;
  options_.threads = 2;
  std::atomic<int> told{0};
  options_.progress = [&](std::size_t, std::size_t) {
    ++told;
    throw std::runtime_error("the terminal is gone");
  };
  EXPECT_THROW(solve(ToolScene::Shape::sphere, test::ResponseSampleOptions::Tools::sphere), std::runtime_error);
  EXPECT_EQ(told, 1);
}

TEST(RecordedContacts, OfAToolThatTheFileDoesNotHaveAreNamed) {
  const std::vector<std::byte> bytes = encode(test::ball_content());
  const runtime::View view = runtime::View::open(bytes.data(), bytes.size()).view;
  std::vector<HeldOut> contacts(3);
  contacts[2].tool = 7;
  try {
    compare_with_file(view, contacts, "report.json");
    FAIL() << "it was compared";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).rfind("report.json: contact 2 names tool 7; ", 0), 0U) << error.what();
  }
}

}  // namespace
}  // namespace palpate::verify
