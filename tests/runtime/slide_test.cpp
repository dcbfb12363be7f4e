// SPDX-License-Identifier: GPL-3.0-or-later
// A ball tip that is drawn sideways over a box and a ball: it sticks, slides, goes on over patches and edges.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/runtime/straight_moves.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;

TEST(Contact, SidewaysItSticksThenSlidesAtTheLimit) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  const double depth = 0.004;
  move(contact, centre(-0.001), centre(depth));
  bool slid = false;
  move(contact, centre(depth), centre(depth, 0.004), 1e-5, [&](const Pose& pose, const Tick& tick) {
    const double sideways = std::hypot(tick.force.x, tick.force.y);
    EXPECT_NEAR(tick.depth, depth, 1e-8);
    if (!slid && tick.state == State::stick) {
      EXPECT_NEAR(tick.body_point.x, 0, 1e-9);
      EXPECT_LE(sideways, tick.friction_limit * (1 + 1e-6));
      const Vec3 deflection = pose.translation - Vec3{0, 0, box.view.tools[0].probe_radius} - tick.body_point;
      EXPECT_LT(distance(tick.force, contact.field().force(deflection).force), 1e-9);
      return;
    }
    slid = true;
    if (tick.state == State::slide) {
      EXPECT_NEAR(sideways, tick.friction_limit, 1e-4 * tick.friction_limit);
      EXPECT_GT(tick.body_point.x, 0);
    }
    EXPECT_LT(tick.force.x, 0);
  });
  EXPECT_TRUE(slid);
  // Turning back sticks at once.
  const Tick back = contact.tick(upright(centre(depth, 0.004 - 1e-5)));
  EXPECT_EQ(back.state, State::stick);
}

// A body that pushes a straight tool aside does so while it slides, too: friction comes on top, alike every way.
TEST(Contact, FrictionHoldsItsLimitAboutWhatTheFlanksPush) {
  for (const int coupled : {0, 2, 4}) {
    for (const bool rim : {false, true}) {
      Options options;
      options.coupled = coupled;
      options.rim = rim;
      const Opened box(box_content(options));
      double aside = 0;
      for (int k = 0; k < 8; ++k) {
        const double angle = 0.25 * k * std::numbers::pi, depth = 0.0035;
        const Vec3 to{std::cos(angle), std::sin(angle), 0}, start{-0.0013, 0.0017, 0};
        Contact contact(box.view, 0);
        move(contact, centre(-0.0005) + start, centre(depth) + start);
        Tick tick;
        move(contact, centre(depth) + start, centre(depth) + start + 0.003 * to, 1e-5,
             [&](const Pose&, const Tick& each) { tick = each; });
        ASSERT_EQ(tick.state, State::slide);
        const Vec3 straight = contact.field().at_depth(tick.depth).straight;
        const double flanks = 0.25 + 0.75 * std::sqrt(tick.depth / kDepthScale);
        const Vec3 friction{tick.force.x - flanks * straight.x, tick.force.y - flanks * straight.y, 0};
        EXPECT_NEAR(length(friction), tick.friction_limit, (rim ? 0.02 : 1e-3) * tick.friction_limit);
        EXPECT_LT(dot(friction, to), -0.9 * tick.friction_limit);
        aside = std::max(aside, length(straight) / tick.friction_limit);
      }
      EXPECT_GT(aside, 0.03);
    }
  }
}

// A contact that went deeper aslant has left its anchor ahead of c. Where it begins to slide c takes that over as it
// goes, not at once: the next place answers otherwise. In the end it slides as one that was pressed straight.
TEST(Contact, BeginsToSlideWithoutAStep) {
  for (const int coupled : {0, 2}) {
    Options options;
    options.coupled = coupled;
    const Opened box(box_content(options));
    for (int k = 0; k < 8; ++k) {
      const double angle = 0.25 * k * std::numbers::pi, depth = 0.0035, step = 2.5e-6;
      const Vec3 to{std::cos(angle), std::sin(angle), 0}, start{-0.0013, 0.0017, 0};
      Contact contact(box.view, 0), straight(box.view, 0);
      move(contact, centre(-0.0005) + start, centre(depth) + start + 0.0004 * to);
      move(straight, centre(-0.0005) + start, centre(depth) + start);
      Tick last = contact.tick(upright(centre(depth) + start + 0.0004 * to));
      ASSERT_EQ(last.state, State::stick);
      ASSERT_GT(length(last.force), 0.5);
      int begun = 0;
      move(contact, centre(depth) + start + 0.0004 * to, centre(depth) + start + 0.004 * to, step,
           [&](const Pose&, const Tick& tick) {
             begun += last.state == State::stick && tick.state == State::slide;
             EXPECT_LT(distance(tick.force, last.force), 1500 * step) << "17 000 N/m with c taking it over at once";
             EXPECT_LT(distance(tick.body_point, last.body_point), 6 * step);
             last = tick;
           });
      EXPECT_GE(begun, 1);
      move(straight, centre(depth) + start, centre(depth) + start + 0.004 * to, step, [](const Pose&, const Tick&) {});
      const Tick plain = straight.tick(upright(centre(depth) + start + 0.004 * to));
      EXPECT_LT(distance(plain.force, last.force), 5e-3 * length(plain.force));
      EXPECT_LT(distance(plain.body_point, last.body_point), 1e-5);
    }
  }
}

TEST(Contact, SlidingLosesEnergy) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  move(contact, centre(-0.001), centre(0.003));
  double work_on_body = 0;
  Vec3 last = centre(0.003), last_force{0, 0, hertz(0.003)};
  const auto account = [&](const Pose& pose, const Tick& tick) {
    work_on_body -= dot(0.5 * (tick.force + last_force), pose.translation - last);
    last = pose.translation;
    last_force = tick.force;
  };
  for (int round = 0; round < 3; ++round) {
    move(contact, centre(0.003), centre(0.003, 0.006, 0.002), 1e-5, account);
    move(contact, centre(0.003, 0.006, 0.002), centre(0.003), 1e-5, account);
  }
  // About the limit along the whole way, less what the sticking part stores.
  const double limit = 0.3 * hertz(0.003), way = 6 * std::hypot(0.006, 0.002);
  EXPECT_GT(work_on_body, 0.5 * limit * way);
  EXPECT_LT(work_on_body, 1.2 * limit * way);
}

TEST(Contact, SlidingOverPatchesIsContinuous) {
  Options options;
  options.subdivision = 4;
  for (const bool friction : {true, false}) {
    options.friction = friction;
    const Opened body(ball_content(options));
    Contact contact(body.view, 0);
    constexpr double kStep = 5e-6, kStiffness = 3000;  // N/m, above any slope of the sample curves
    const auto orbit = [](double angle, double depth) {
      const double r = kBallRadius + kTipRadius - depth;
      return upright({r * std::sin(angle), 0.1 * r * std::sin(3 * angle), r * std::cos(angle)});
    };
    for (int i = 0; i <= 1000; ++i) contact.tick(orbit(0, -0.001 + 0.004 * i / 1000));
    Tick last = contact.tick(orbit(0, 0.003));
    ASSERT_GT(length(last.force), 0.1);
    std::uint32_t patches = 0;
    const std::uint32_t* patch = nullptr;  // its sites
    for (double angle = 0; angle < 2.5; angle += kStep / kBallRadius) {
      const Tick tick = contact.tick(orbit(angle, 0.003));
      ASSERT_TRUE(tick.state == State::slide || tick.state == State::stick) << angle;
      ASSERT_LT(distance(tick.force, last.force), kStiffness * 2 * kStep) << angle << " friction " << friction;
      const auto& sites = body.view.triangles[tick.at.triangle].site;
      patches += patch == nullptr || !std::equal(sites, sites + 3, patch) ? 1 : 0;
      patch = sites;
      last = tick;
    }
    EXPECT_GT(patches, 10U);
  }
}

TEST(Contact, FrictionlessPointFollowsTheTool) {
  Options options = uniform();
  options.friction = options.lateral = false;
  const Opened box(box_content(options));
  Contact contact(box.view, 0);
  move(contact, centre(-0.001, -0.01), centre(0.003, -0.01));
  move(contact, centre(0.003, -0.01), centre(0.003, 0.01, 0.003), 2e-5, [](const Pose& pose, const Tick& tick) {
    EXPECT_EQ(tick.state, State::slide);
    EXPECT_NEAR(tick.body_point.x, pose.translation.x, 1e-8);
    EXPECT_LT(distance(tick.force, {0, 0, hertz(0.003)}), 1e-4);
  });
}

// Over the box's edge the normals turn by a right angle within a patch: c has to follow round it.
TEST(Contact, SlidesOverAnEdgeWithoutAJump) {
  for (const bool friction : {false, true}) {
    Options options = flat();
    options.friction = friction;
    options.subdivision = 3;
    const Opened box(box_content(options));
    Contact contact(box.view, 0);
    constexpr double kDepth = 0.001, kStep = 2e-6, kHalf = kBoxSize / 2;
    move(contact, centre(-0.001, 0.02), centre(kDepth, 0.02));
    Tick last = contact.tick(upright(centre(kDepth, 0.02)));
    double largest = 0;
    const auto watch = [&](const Pose&, const Tick& tick) {
      largest = std::fmax(largest, distance(tick.force, last.force));
      last = tick;
    };
    // Along the top, round the edge on a quarter circle, down the side.
    const double r = kTipRadius - kDepth;
    move(contact, centre(kDepth, 0.02), centre(kDepth, kHalf), kStep, watch);
    for (int i = 0; i <= 4000; ++i) {
      const double angle = std::numbers::pi / 2 * i / 4000;
      const Pose pose = upright({kHalf + r * std::sin(angle), 0, kTop + r * std::cos(angle)});
      watch(pose, contact.tick(pose));
    }
    move(contact, {kHalf + r, 0, kTop}, {kHalf + r, 0, 0}, kStep, watch);
    EXPECT_LT(largest, 3000 * 2 * kStep) << friction;
    EXPECT_GT(last.force.x, 0.05);  // it presses on the side now
  }
}

// Far deeper than the normals' focal points, c cannot follow round the edge: it goes to the nearest side by parts of
// the way, as far as the force may turn with the tool's way, and the force never grows for it.
TEST(Contact, HandingOverToAnotherSideNeitherRaisesTheForceNorTurnsItAtOnce) {
  for (const double depth : {0.012, 0.016}) {
    for (const double stride : {2e-6, 4e-4}) {
      Options options = flat();
      options.friction = false;
      options.subdivision = 3;
      const Opened box(box_content(options));
      Contact contact(box.view, 0);
      move(contact, centre(-0.001, 0.02), centre(depth, 0.02));
      Tick last = contact.tick(upright(centre(depth, 0.02)));
      double largest = 0;
      move(contact, centre(depth, 0.02), centre(depth, 0.04), stride, [&](const Pose&, const Tick& tick) {
        ASSERT_LT(length(tick.force), length(last.force) + 3000 * 2 * stride);
        largest = std::fmax(largest, distance(tick.force, last.force));
        last = tick;
      });
      EXPECT_LT(largest, 3000 * 4.5 * stride) << depth << " " << stride;
    }
  }
}

// Sites of very different stiffness, the tool far past the normals' focal points: where a hand-over is tried and
// declined, it must leave nothing behind.
TEST(Contact, HeldStillWhereItCannotBeHandedOverTheForceStays) {
  int held = 0;
  for (const unsigned seed : {40U, 84U}) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    Options options = flat();
    options.friction = false;
    options.cells = 2;
    ResponseFileContent content = box_content(options);
    for (Response& r : content.responses) {
      const double factor = std::pow(10, unit(random) - 1);
      for (float& c : r.normal) c = static_cast<float>(c * factor);
    }
    const Opened box(std::move(content));
    for (int run = 0; run < 10; ++run) {
      const auto draw = [&] { return unit(random); };
      const double x = draw(), y = draw(), to_x = draw(), to_y = draw(), to_z = draw();
      const Vec3 from{0.03 * x, 0.03 * y, kTop + kTipRadius + 1e-4}, to{0.04 * to_x, 0.04 * to_y, 0.02 * to_z};
      Contact contact(box.view, 0);
      int ticks = 0;
      move(contact, from, to, 5e-5, [&](const Pose& pose, const Tick& tick) {
        if (++ticks % 20 != 0 || length(tick.force) < 0.02) return;
        Contact still = contact;
        const double first = length(still.tick(pose).force);
        for (int i = 0; i < 100; ++i) ASSERT_NEAR(length(still.tick(pose).force), first, 1e-3 * first) << i;
        ++held;
      });
    }
  }
  EXPECT_GT(held, 200);
}

}  // namespace
}  // namespace palpate
