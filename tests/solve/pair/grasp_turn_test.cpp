// SPDX-License-Identifier: GPL-3.0-or-later
// Torques of a turned tool on a bonded contact, against closed forms of rigid discs on a half-space.
#include "formats/response/response.hpp"
#include "palpate/contact/bonded_contact.hpp"
#include "palpate/format/open.hpp"
#include "precompute/fit/laws/turn_fit.hpp"
#include "tests/support/press.hpp"
#include "tests/support/response_samples.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace palpate::solve::grasp_turn_test {
namespace {

constexpr double kYoung = 5e3, kPoisson = 0.49, kShear = kYoung / (2 * (1 + kPoisson));

// A file whose every response is fitted to these grasped samples.
std::vector<std::byte> file_of(const std::vector<Sample>& samples, double depth) {
  test::ResponseSampleOptions options;
  options.uniform = options.bonded = options.bonded_torque = true;
  options.friction = options.bias = false;
  ResponseFileContent content = test::box_content(options);
  content.depth_scale = depth;
  for (ResponseSite& s : content.sites) s.depth_limit = depth;
  content.bonded_coefs = fit::kGraspCoefs;
  const fit::GraspCurves grasp = fit::fit_grasp(samples, depth, "punch");
  const fit::TurnCurves turn = fit::fit_turns(samples, grasp, depth, "punch");
  for (Response& r : content.responses) {
    r.depth_limit = depth;
    r.bonded_depth = grasp.depth;
    r.bonded_pulled = grasp.pulled;
    r.bonded.assign(grasp.curves.begin(), grasp.curves.end());
    r.rotated = turn.turned;
    r.bonded_torque.assign(turn.curves.begin(), turn.curves.end());
  }
  return encode(content);
}

// A five hundredth of its radius deep: pressures that stiffen the surface by less than 1 %. The tractions are singular
// at the rim, which takes a ring of small elements. As solved, and as a file of these samples answers.
TEST(TurnedPunch, AnswersTwistAndRollingAsARigidDisc) {
  const double radius = 0.005, depth = 0.002 * radius;
  ToolScene punch;
  punch.shape = ToolScene::Shape::punch;
  punch.radius = radius;
  punch.edge_radius = 0.002 * radius;
  PairPath path;
  path.normal_depths = {0.5 * depth, depth};
  path.grasp_depth = depth;
  path.grasp_depths = {0.0, 0.5 * depth};
  path.grasp_directions = 2;
  path.grasp_points = 1;
  path.grasp_reach = 0.2 * depth;
  path.grasp_turns = {{0.0005, 0, 0}, {0, -0.0005, 0}, {0, 0, 0.0005}};
  PairOptions options;
  options.rim_size = 0.05;
  const PairResult r = test::press(test::block_body(20 * radius, kYoung, kPoisson), punch, path, options);
  ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
  EXPECT_EQ(r.outcome.cause, "");
  // Twist: Reissner and Sagoci 1944. Rolling: Johnson 1985, section 5.1 has the bonded disc, which where nu is near a
  // half is the frictionless one, 8 G a^3 / (3 (1 - nu)).
  const double twist = 16.0 / 3 * kShear * std::pow(radius, 3), roll = twist / (2 * (1 - kPoisson));
  int twists = 0, rolls = 0;
  for (const Sample& s : r.samples) {
    if (s.kind != SampleKind::grasped || s.rotation.isZero(0)) continue;
    const bool about_normal = s.rotation.z() != 0;
    ++(about_normal ? twists : rolls);
    const double stiffness = -s.torque.dot(s.rotation) / s.rotation.squaredNorm();
    EXPECT_NEAR(stiffness / (about_normal ? twist : roll), 1.0, 0.03) << s.rotation.transpose();
    EXPECT_LT((s.torque - s.torque.dot(s.rotation.normalized()) * s.rotation.normalized()).norm(),
              0.02 * s.torque.norm());
    EXPECT_LT(std::min(std::abs(s.deflection.z()), std::abs(s.deflection.z() - 0.5 * depth)), 0.02 * depth);
  }
  EXPECT_EQ(twists, 2);
  EXPECT_EQ(rolls, 4);
  const std::vector<std::byte> bytes = file_of(r.samples, depth);
  const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
  ASSERT_TRUE(opened) << opened.error;
  const runtime::Location top = closest_point(opened.view, {0, 0, test::kBoxSize / 4});
  const runtime::BondedResponse<true> response(opened.view, 0, top.at, {});
  for (const double angle : {-0.0003, 0.0004}) {
    for (const double z : {0.1 * depth, 0.4 * depth}) {
      EXPECT_NEAR(response.at({0, 0, -z}, {0, 0, angle}).torque.z / (-angle * twist), 1.0, 0.04);
      EXPECT_NEAR(response.at({0, 0, -z}, {0, angle, 0}).torque.y / (-angle * roll), 1.0, 0.04);
      const double oblique = angle / std::sqrt(2.0);
      EXPECT_NEAR(response.at({0, 0, -z}, {oblique, 0, oblique}).torque.z / (-oblique * twist), 1.0, 0.04);
    }
  }
}

// Rolling a round tip about the point by which it touched drags that point's surroundings aside: the force of a turn
// and the torque of a tangential move are the same derivative of one energy.
TEST(TurnedSphere, ForceOfATurnIsTheTorqueOfAMove) {
  PairPath path;
  path.normal_depths = {0.001, 0.002};
  path.friction = 0.3;
  path.grasp_depth = 0.002;
  path.grasp_depths = {0.001, 0.0015, 0.002};
  path.grasp_directions = 4;
  path.grasp_points = 1;
  path.grasp_reach = 1e-4;
  path.grasp_turns = {{0, 0.02, 0}, {0, 0, 0.02}};
  PairOptions options;
  options.tolerance = 1e-5;  // what turns and moves add is small beside the force of the push
  options.refine = 0.6;      // and scatters by 5 % with a mesh of the default's elements
  const PairResult r = test::press(test::block_body(0.03, kYoung, kPoisson), ToolScene{}, path, options);
  ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
  const Sample *rest = nullptr, *moved = nullptr, *rolled = nullptr, *twisted = nullptr;
  for (const Sample& s : r.samples) {
    if (s.kind != SampleKind::grasped) continue;
    // The first moved and the first rotated samples are at the deepest point.
    const bool still = s.rotation.isZero(0) && s.deflection.head<2>().norm() < 5e-5;
    if (still && (rest == nullptr || s.deflection.z() > rest->deflection.z())) rest = &s;
    if (moved == nullptr && s.deflection.x() > 5e-5) moved = &s;
    if (rolled == nullptr && s.rotation.y() > 0) rolled = &s;
    if (twisted == nullptr && s.rotation.z() > 0) twisted = &s;
  }
  ASSERT_TRUE(moved != nullptr && rolled != nullptr && twisted != nullptr);
  const double force = (rolled->force.x() - rest->force.x()) / rolled->rotation.y();
  const double torque = (moved->torque.y() - rest->torque.y()) / moved->deflection.x();
  EXPECT_GT(std::abs(torque), 0.01 * std::abs(rolled->torque.y() / rolled->rotation.y()) / 0.005);
  EXPECT_NEAR(rolled->deflection.z(), rest->deflection.z(), 1e-6);
  EXPECT_NEAR(moved->deflection.z(), rest->deflection.z(), 1e-6);
  EXPECT_NEAR(force / torque, 1.0, 0.05);
  EXPECT_LT(twisted->torque.z(), 0.0);
  EXPECT_LT((twisted->force - rest->force).norm(), 0.01 * rest->force.norm());
}

}  // namespace
}  // namespace palpate::solve::grasp_turn_test
