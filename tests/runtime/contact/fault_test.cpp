// SPDX-License-Identifier: GPL-3.0-or-later
// Faults: each has its cause, no force, and the contact is forgotten.
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "tests/runtime/support.hpp"

namespace palpate::fault_test {
namespace {

using namespace test;
using runtime::Contact;
using runtime::ContactSet;
using runtime::Fault;
using runtime::RigidMotion;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();

void expect_fault(const Tick& tick, Fault fault) {
  EXPECT_EQ(tick.state, State::fault);
  EXPECT_EQ(static_cast<int>(tick.fault), static_cast<int>(fault)) << describe(tick.fault);
  EXPECT_EQ(length(tick.force), 0);
  EXPECT_EQ(length(tick.torque), 0);
  EXPECT_FALSE(tick.touches());
}

TEST(Fault, WrongPoseIsNamedAndTheContactIsForgotten) {
  const Opened box(box_content(flat()));
  const Vec3 in = centre(0.003);
  const Pose wrong[] = {upright({kNan, 0, 0}),
                        upright({0, kInf, 0}),
                        upright({0, 0, 2e6}),
                        {{kNan, 0, 0, 0, 1, 0, 0, 0, 1}, in},
                        {{2, 0, 0, 0, 1, 0, 0, 0, 1}, in},
                        {{-1, 0, 0, 0, 1, 0, 0, 0, 1}, in},
                        Pose::from_quaternion(0, 0, 0, 0, in)};
  for (const Pose& pose : wrong) {
    Contact contact(box.view, 0);
    ContactSet<3> set(box.view, 0);
    EXPECT_GT(length(move(contact, centre(-0.001), in).force), 0.1);
    EXPECT_GT(length(move(set, centre(-0.001), in).force), 0.1);
    expect_fault(contact.tick(pose), Fault::bad_pose);
    expect_fault(set.tick(pose), Fault::bad_pose);
    EXPECT_EQ(length(contact.tick(upright(in)).force), 0) << "it begins anew";
    EXPECT_EQ(length(set.tick(upright(in)).force), 0);
  }
}

TEST(Fault, WrongPoseOfTheBodyIsNamed) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  Pose wrong;
  wrong.rotation[4] = kNan;
  expect_fault(contact.tick(upright(centre(0.003)), RigidMotion{&box.view, wrong}), Fault::bad_pose);
}

TEST(Fault, ToolThatTheFileDoesNotHaveIsNamed) {
  for (const auto tools : {Options::Tools::sphere, Options::Tools::all}) {
    Options options;
    options.tools = tools;
    options.search = true;
    const Opened ball(ball_content(options));
    const runtime::View& view = ball.view;
    for (const std::uint32_t tool : {view.find_tool("no such tool"), 1000u, 0xffffffffu}) {
      Contact contact(view, tool), coupled(view, tool);
      ContactSet<2> set(view, tool);
      runtime::VirtualCoupling coupling(runtime::CouplingOptions{});
      for (const double height : {1.0, 0.05, 0.0, 1.0}) {
        const Pose pose = upright({0, 0, height});
        const runtime::Search latest = runtime::search(view, tool, pose);
        expect_fault(contact.tick(pose), Fault::no_such_tool);
        expect_fault(contact.tick(pose, latest), Fault::no_such_tool);
        expect_fault(contact.tick(pose, RigidMotion{&view, Pose()}), Fault::no_such_tool);
        expect_fault(set.tick(pose), Fault::no_such_tool);
        expect_fault(coupling.tick(coupled, pose, 1e-3), Fault::no_such_tool);
      }
    }
  }
}

TEST(Fault, SearchOfALargerFileIsNamed) {
  Options many, few;
  many.cells = 8;
  for (Options* options : {&many, &few}) options->tools = Options::Tools::all;
  const Opened before(box_content(many)), now(box_content(few));
  const Pose in = upright(centre(0.002));
  for (std::uint32_t tool = 0; tool < 3; ++tool) {
    const runtime::Search good = runtime::search(now.view, tool, in);
    runtime::Search elsewhere = good, other_tool = good, no_pose = good;
    elsewhere.touch.body.at.triangle = before.view.meta->triangle_count - 1;
    ASSERT_GE(elsewhere.touch.body.at.triangle, now.view.meta->triangle_count);
    other_tool.touch.core.at.patch = now.view.meta->tool_patch_count;
    no_pose.pose.translation.x = kNan;
    Contact contact(now.view, tool);
    expect_fault(contact.tick(in, elsewhere), Fault::bad_search);
    expect_fault(contact.tick(in, no_pose), Fault::bad_search);
    EXPECT_EQ(contact.tick(in, other_tool).state == State::fault, tool == 2) << "a mesh alone reads its patch";
    EXPECT_NE(contact.tick(in, good).state, State::fault);
  }
}

TEST(Fault, ViewThatWasNotOpenedHasNoTool) {
  const runtime::OpenResult refused = runtime::View::open(nullptr, 0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.view.find_tool("ball"), 0U);
  Contact contact(refused.view, 0);
  runtime::BasicContact<0> lean(refused.view, 0);
  ContactSet<2> set(refused.view, 0);
  for (const double height : {0.1, -0.1, 0.0}) {
    const Pose pose = upright({0, 0, height});
    expect_fault(contact.tick(pose), Fault::no_such_tool);
    expect_fault(contact.tick(pose, runtime::search(refused.view, 0, pose)), Fault::no_such_tool);
    expect_fault(lean.tick(pose), Fault::no_such_tool);
    expect_fault(set.tick(pose), Fault::no_such_tool);
  }
}

TEST(Fault, CouplingNamesTimeAndOptions) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  runtime::CouplingOptions options;
  runtime::VirtualCoupling good(options);
  expect_fault(good.tick(contact, upright(centre(-0.001)), -1e-3), Fault::bad_time);
  expect_fault(good.tick(contact, upright(centre(-0.001)), kNan), Fault::bad_time);
  options.stiffness = -1;
  runtime::VirtualCoupling wrong(options);
  expect_fault(wrong.tick(contact, upright(centre(-0.001)), 1e-3), Fault::bad_option);
}

TEST(Fault, EveryCauseHasWordsOfItsOwn) {
  const Fault all[] = {Fault::none, Fault::bad_pose, Fault::no_such_tool, Fault::feature_left_out, Fault::bad_search,
                       Fault::bad_time, Fault::bad_option};
  for (const Fault a : all) {
    EXPECT_GT(std::string(describe(a)).size(), 5U);
    for (const Fault b : all) EXPECT_EQ(a == b, std::string(describe(a)) == describe(b));
  }
}

}  // namespace
}  // namespace palpate::fault_test
