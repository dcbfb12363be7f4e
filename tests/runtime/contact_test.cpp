// SPDX-License-Identifier: GPL-3.0-or-later
// A ball tip on a box and a ball: push, release, late detection, leaps, faults.
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "tests/runtime/straight_moves.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;

TEST(Contact, PushAndLiftFollowTheCurve) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  const Vec3 side = {0.002, -0.001, 0};
  const auto check = [&](const Pose& pose, const Tick& tick) {
    const double depth = kTop + kTipRadius - pose.translation.z;
    if (depth <= 1e-9) {
      EXPECT_EQ(length(tick.force), 0);
      EXPECT_TRUE(tick.state == State::free || tick.state == State::released);
      return;
    }
    EXPECT_EQ(tick.state, State::stick);
    EXPECT_NEAR(tick.depth, depth, 1e-8);
    EXPECT_LT(distance(tick.force, {0, 0, hertz(depth)}), 1e-4);
    EXPECT_LT(distance(tick.body_point, Vec3{side.x, side.y, kTop}), 1e-8);
  };
  move(contact, centre(-0.01) + side, centre(0.005) + side, 2e-5, check);
  move(contact, centre(0.005) + side, centre(-0.01) + side, 2e-5, check);
}

TEST(Contact, EndsWithOneReleasedTickAndNoForce) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  move(contact, centre(-0.001), centre(0.002));
  int released = 0;
  double last = 1;
  move(contact, centre(0.002), centre(-0.001), 1e-6, [&](const Pose&, const Tick& tick) {
    released += tick.state == State::released;
    EXPECT_LE(length(tick.force), last + 1e-12);
    if (tick.state == State::released) {
      EXPECT_LT(last, 2e-4);  // the tick before was nearly zero already
    }
    last = length(tick.force);
  });
  EXPECT_EQ(released, 1);
  EXPECT_EQ(last, 0);
}

TEST(Contact, StartingInsideBeginsAtZero) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  const Tick first = contact.tick(upright(centre(0.003)));
  EXPECT_EQ(length(first.force), 0);
  move(contact, centre(0.003), centre(0.004));
  const Tick deeper = contact.tick(upright(centre(0.004)));
  EXPECT_NEAR(deeper.depth, 0.001, 1e-8);
  EXPECT_NEAR(length(deeper.force), hertz(0.001), 1e-4);
}

// Rotations are taken that are orthonormal to 1e-3; what is missing is not a turn, and nothing rolls.
TEST(Contact, AtRestUnderARotationThatIsNotQuiteOneNothingMoves) {
  const Opened box(box_content(uniform()));
  for (const double skew : {3e-8, 5e-4}) {
    Contact contact(box.view, 0);
    const auto pose = [&](double depth) {
      Pose result = upright(centre(depth, 0.001));
      result.rotation[6] = skew;
      return result;
    };
    for (int k = -10; k <= 300; ++k) contact.tick(pose(1e-5 * k));
    const Tick first = contact.tick(pose(0.003));
    ASSERT_GT(length(first.force), 0.1);
    Tick last;
    for (int k = 0; k < 20000; ++k) last = contact.tick(pose(0.003));
    EXPECT_LT(distance(last.force, first.force), 1e-9 * length(first.force)) << skew;
    EXPECT_LT(distance(last.body_point, first.body_point), 1e-12) << skew;
  }
}

// Up to a contact's size a tick counts as a motion, as of a tool that touches already.
TEST(Contact, AJumpIntoTheBodyBeginsAtZero) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0), moved(box.view, 0);
  const double size = contact.size();
  EXPECT_EQ(contact.tick(upright(centre(0.003 - 1.01 * size))).state, State::free);
  EXPECT_EQ(length(contact.tick(upright(centre(0.003))).force), 0);
  EXPECT_EQ(moved.tick(upright(centre(0.003 - 0.99 * size))).state, State::free);
  EXPECT_NEAR(moved.tick(upright(centre(0.003))).depth, 0.003, 1e-8);
}

// A dropped packet, a host that moves the tool by hand: what it finds inside the body is no work of the hand.
TEST(Contact, AJumpAcrossTheBodyDoesNotRaiseTheForce) {
  Options options;
  options.subdivision = 3;
  for (const bool friction : {false, true}) {
    options.friction = friction;
    const Opened body(ball_content(options));
    for (int k = 1; k < 12; ++k) {
      Contact contact(body.view, 0);
      const double angle = std::numbers::pi * k / 12, far = kBallRadius + kTipRadius;
      for (int i = 0; i <= 200; ++i) contact.tick(upright({0, 0, far + 0.001 - 1e-5 * i}));
      const double before = length(contact.tick(upright({0, 0, far - 0.001})).force);
      ASSERT_GT(before, 0.01);
      const double r = far - 0.006;
      const Vec3 at = {r * std::sin(angle), 0, r * std::cos(angle)};
      if (distance(at, {0, 0, far - 0.001}) < kTipRadius + kDepthScale) continue;  // that is a motion
      const Tick there = contact.tick(upright(at));
      EXPECT_LE(length(there.force), before) << k << " friction " << friction;
    }
  }
}

TEST(Contact, WrongPosesAreFaultsWithoutForce) {
  const Opened box(box_content(flat()));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  const Vec3 in = centre(0.003);
  const Pose wrong[] = {upright({kNan, 0, 0}),
                        upright({0, kInf, 0}),
                        upright({0, 0, 2e6}),
                        {{kNan, 0, 0, 0, 1, 0, 0, 0, 1}, in},
                        {{2, 0, 0, 0, 1, 0, 0, 0, 1}, in},
                        {{-1, 0, 0, 0, 1, 0, 0, 0, 1}, in},
                        {{0, 0, 0, 0, 0, 0, 0, 0, 0}, in},
                        Pose::from_quaternion(0, 0, 0, 0, in),
                        Pose::from_quaternion(kNan, 0, 0, 1, in)};
  for (const Pose& pose : wrong) {
    Contact contact(box.view, 0);
    move(contact, centre(-0.001), in);
    const Tick tick = contact.tick(pose);
    EXPECT_EQ(tick.state, State::fault);
    EXPECT_EQ(length(tick.force), 0);
    EXPECT_EQ(length(tick.torque), 0);
    // Afterwards the contact was forgotten: inside the body it begins at zero.
    EXPECT_EQ(length(contact.tick(upright(in)).force), 0);
  }
}

// As find_tool gives it for a name that is not in the file: the index after the last, or any.
TEST(Contact, OfAToolThatIsNotThereEveryTickIsAFault) {
  for (const auto tools : {Options::Tools::sphere, Options::Tools::all}) {
    Options options;
    options.tools = tools;
    options.search = true;
    const Opened ball(ball_content(options));
    const runtime::View& view = ball.view;
    const double far = 1;
    for (const std::uint32_t tool : {view.find_tool("no such tool"), 1000u, 0xffffffffu}) {
      Contact contact(view, tool), searched(view, tool);
      runtime::MovingContact moving(view, tool);
      runtime::SeveralContacts<2> several(view, tool);
      runtime::SeveralTools<2> tools_of(view, {0, tool});
      runtime::VirtualCoupling tie(runtime::CouplingOptions{});
      Contact tied(view, tool);
      for (const double height : {far, 0.05, 0.0, far}) {
        const Pose pose = upright({0, 0, height});
        const runtime::Search latest = runtime::search(view, tool, pose);
        const Tick ticks[] = {contact.tick(pose),        searched.tick(pose, latest), searched.tick_found(pose, latest),
                              moving.tick(Pose(), pose), several.tick(pose).each[0],  tools_of.tick({pose, pose})[1],
                              tie.tick(tied, pose, 1e-3)};
        for (const Tick& tick : ticks) {
          ASSERT_EQ(tick.state, State::fault) << tool << ' ' << height;
          ASSERT_EQ(length(tick.force), 0);
        }
      }
      const runtime::Places<2> places{upright({0, 0, far}), 0, {}};
      EXPECT_GT(runtime::search(view, tool, places).first.touch.clearance, 0);
    }
  }
}

// As where a tracker has not taken the file yet that the force loop has.
TEST(Contact, ASearchOfALargerFileIsAFault) {
  Options many, few;
  many.cells = 8;
  for (Options* options : {&many, &few}) options->tools = Options::Tools::all;
  const Opened before(box_content(many)), now(box_content(few));
  const Pose in = upright(centre(0.002));
  for (std::uint32_t tool = 0; tool < 3; ++tool) {
    runtime::Search good = runtime::search(now.view, tool, in), elsewhere = good, other_tool = good;
    elsewhere.touch.body.at.triangle = before.view.meta->triangle_count - 1;
    ASSERT_GE(elsewhere.touch.body.at.triangle, now.view.meta->triangle_count);
    other_tool.touch.tool_point.patch = now.view.meta->tool_patch_count;
    const auto pressed = [&](Contact& contact) {
      for (double z = 0.05; z > in.translation.z; z -= 1e-4) {
        const Pose pose = upright({0, 0, z});
        contact.tick(pose, runtime::search(now.view, tool, pose));
      }
      return contact.tick(in, good).touches();
    };
    Contact begins(now.view, tool), lasts(now.view, tool);
    EXPECT_EQ(begins.tick(in, elsewhere).state, State::fault);
    EXPECT_EQ(begins.tick_found(in, elsewhere).state, State::fault);
    EXPECT_EQ(begins.tick(in, other_tool).state == State::fault, tool == 2) << "only a mesh's is read";
    EXPECT_NE(begins.tick(in, good).state, State::fault);
    ASSERT_TRUE(pressed(lasts));
    EXPECT_EQ(lasts.tick(in, elsewhere).state, State::fault);
    EXPECT_EQ(length(lasts.tick(in, good).force), 0) << "it is forgotten";
  }
}

// As of a file that was refused, by a host that did not look.
TEST(Contact, OfAViewThatWasNotOpenedEveryTickIsAFault) {
  const runtime::OpenResult refused = runtime::View::open(nullptr, 0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.view.find_tool("ball"), 0U);
  Contact contact(refused.view, 0);
  runtime::BasicContact<0> lean(refused.view, 0);
  runtime::MovingContact moving(refused.view, 0);
  runtime::SeveralContacts<2> several(refused.view, 0);
  for (const double height : {0.1, -0.1, 0.0}) {
    const Pose pose = upright({0, 0, height});
    EXPECT_EQ(contact.tick(pose).state, State::fault);
    EXPECT_EQ(contact.tick(pose, runtime::search(refused.view, 0, pose)).state, State::fault);
    EXPECT_EQ(lean.tick(pose).state, State::fault);
    EXPECT_EQ(moving.tick(Pose(), pose).state, State::fault);
    EXPECT_EQ(several.tick(pose).each[0].state, State::fault);
  }
}

// A contact keeps the view's address: of a temporary, as View::open(...).view, it does not compile.
TEST(Contact, IsNotMadeOfATemporaryView) {
  using runtime::View;
  const auto refuses = [](auto type) {
    using Kept = typename decltype(type)::type;
    return std::is_constructible_v<Kept, const View&, std::uint32_t> &&
           std::is_constructible_v<Kept, View&, std::uint32_t> && !std::is_constructible_v<Kept, View, std::uint32_t> &&
           !std::is_constructible_v<Kept, const View, std::uint32_t>;
  };
  static_assert(refuses(std::type_identity<Contact>()));
  static_assert(refuses(std::type_identity<runtime::SeveralContacts<2>>()));
  static_assert(refuses(std::type_identity<runtime::ContactsAsOne<2>>()));
  static_assert(refuses(std::type_identity<runtime::PlaceFinder<>>()));
  static_assert(refuses(std::type_identity<runtime::MovingContact>()));
  using Tools = std::array<std::uint32_t, 2>;
  static_assert(std::is_constructible_v<runtime::SeveralTools<2>, const View&, Tools>);
  static_assert(!std::is_constructible_v<runtime::SeveralTools<2>, View, Tools>);
  using runtime::AdjustedContact, runtime::AnimatedContact, runtime::AnimatedSurface, runtime::SiteScales;
  static_assert(std::is_constructible_v<AdjustedContact, const View&, std::uint32_t, SiteScales&>);
  static_assert(std::is_constructible_v<AdjustedContact, View&, std::uint32_t, const SiteScales&, double>);
  static_assert(!std::is_constructible_v<AdjustedContact, View, std::uint32_t, SiteScales&>);
  static_assert(!std::is_constructible_v<AdjustedContact, View&, std::uint32_t, SiteScales>);
  static_assert(!std::is_constructible_v<AdjustedContact, View&, std::uint32_t, SiteScales, double>);
  static_assert(!std::is_constructible_v<AdjustedContact, View, std::uint32_t, SiteScales, double>);
  static_assert(std::is_constructible_v<AnimatedSurface, const View&, void*>);
  static_assert(!std::is_constructible_v<AnimatedSurface, View, void*>);
  static_assert(std::is_constructible_v<AnimatedContact, AnimatedSurface&, std::uint32_t>);
  static_assert(!std::is_constructible_v<AnimatedContact, AnimatedSurface, std::uint32_t>);
}

// As the README says of a host that takes another file while the tool presses.
TEST(Contact, OfAnotherFileTakesOverWhatATickOutsideAndOneAtThePoseGive) {
  Options options = flat();
  const Opened hard(box_content(options));
  ResponseFileContent softer = box_content(options);
  for (auto& response : softer.responses) {
    for (float& coef : response.normal) coef *= 0.5F;
  }
  const Opened soft(softer);
  Contact contact(hard.view, 0);
  move(contact, centre(-1e-4), centre(0.003));
  move(contact, centre(0.003), centre(0.003, 5e-4));
  const Pose pose = upright(centre(0.003, 5e-4));
  const Tick before = contact.tick(pose);
  EXPECT_GT(before.force.x * before.force.x, 1e-6);
  // Begun inside it has no force, and what was deep then is subtracted.
  Contact inside(soft.view, 0);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(length(inside.tick(pose).force), 0);
  contact = Contact(soft.view, 0);
  EXPECT_EQ(contact.tick(upright(centre(-1e-4, 5e-4))).state, State::free);
  const Tick after = contact.tick(pose);
  EXPECT_EQ(after.state, State::stick);
  EXPECT_LT(distance(after.force, {0, 0, 0.5 * hertz(0.003)}), 1e-4);  // the anchor was under the tool then
}

// A device tells the same pose again and again between two steps of its encoders.
TEST(Contact, BegunInsideItWaitsForTheToolToMove) {
  for (const bool friction : {true, false}) {
    Options options = flat();
    options.friction = friction;
    const Opened box(box_content(options));
    Contact contact(box.view, 0);
    const auto wait = [&](double depth) {
      Tick tick;
      for (int i = 0; i < 10; ++i) {
        tick = contact.tick(upright(centre(depth)));
        EXPECT_EQ(tick.state, friction ? State::stick : State::slide) << depth << " " << i;
      }
      return tick;
    };
    double depth = 0.001;
    EXPECT_EQ(length(wait(depth).force), 0);
    Tick tick;
    for (int step = 0; step < 30; ++step) tick = wait(depth += 2e-5);
    EXPECT_NEAR(tick.depth, 6e-4, 1e-9);
    EXPECT_GT(tick.force.z, 0);
  }
}

TEST(Contact, TorqueIsTheLeverTimesTheForce) {
  const Opened ball(ball_content());
  Contact contact(ball.view, 0);
  const Vec3 direction = unit(Vec3{0.3, 0.5, 0.8}, {0, 0, 1});
  Tick tick;
  Pose pose;
  for (int i = 0; i <= 400; ++i) {
    pose = upright((kBallRadius + kTipRadius + 0.001 - 1e-5 * i) * direction);
    tick = contact.tick(pose);
  }
  ASSERT_GT(length(tick.force), 0.1);
  EXPECT_LT(distance(tick.torque, cross(tick.tool_point - pose.translation, tick.force)), 1e-15);
  EXPECT_NEAR(distance(tick.tool_point, pose.translation), kTipRadius, 1e-9);
  EXPECT_GT(dot(tick.force, direction), 0);
}

TEST(Contact, TheContactPointRidesOnABall) {
  Options options = flat();
  options.subdivision = 4;
  const Opened ball(ball_content(options));
  Contact contact(ball.view, 0);
  for (int i = 0; i <= 300; ++i) contact.tick(upright({0, 0, kBallRadius + kTipRadius + 0.001 - 1e-5 * i}));
  for (int i = 0; i <= 20000; ++i) {
    const double a = 2 * i / 20000.0, r = kBallRadius + kTipRadius - 0.002;
    const Vec3 q = {r * std::sin(a), 0, r * std::cos(a)};
    const Tick tick = contact.tick(upright(q));
    ASSERT_LT(distance(tick.body_point, (kBallRadius / r) * q), 0.003);
    ASSERT_NEAR(tick.depth, 0.002, 4e-4);
  }
}

}  // namespace
}  // namespace palpate
