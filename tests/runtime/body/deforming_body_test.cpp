// SPDX-License-Identifier: GPL-3.0-or-later
// A body whose shape a host changes: shapes that are accepted and refused, contacts that move along.
#include "palpate/body/deforming_body.hpp"

#include <fnmatch.h>

#include <cmath>
#include <limits>

#include "tests/runtime/support.hpp"

namespace palpate::deforming_body_test {
namespace {

using namespace test;
using runtime::Contact;
using runtime::DeformingBody;
using runtime::DeformingSurface;
using runtime::RigidMotion;
using runtime::ShapeResult;

constexpr double kFrame = 1.0 / 64, kFrameTick = kFrame / 16;  // s

struct Deformed {
  explicit Deformed(ResponseFileContent content)
      : body(std::move(content)),
        memory(DeformingSurface::bytes(body.view) / sizeof(double) + 1),
        surface(body.view, memory.data()) {}

  template <class Map>
  ShapeResult set(const Map& map, double seconds = kFrame) {
    sites.clear();
    for (std::uint32_t i = 0; i < body.view.meta->site_count; ++i) sites.push_back(map(site(i)));
    return surface.set(sites.data(), body.view.meta->site_count, seconds);
  }
  [[nodiscard]] Vec3 site(std::uint32_t i) const { return runtime::vertex(body.view, i); }

  Opened body;
  std::vector<double> memory;
  DeformingSurface surface;
  std::vector<Vec3> sites;
};

Options searched() {
  Options options;
  options.search = true;
  options.subdivision = 3;
  return options;
}

TEST(DeformingSurface, RigidlyMovedBodyKeepsItsShape) {
  Deformed ball(ball_content(searched()));
  std::mt19937 random(5);
  for (int i = 0; i < 12; ++i) {
    // Half turns about the axes, too: from there nothing says which way back is shorter.
    const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const Pose body = i < 3 ? turned(3.141592653589793, axes[i], {}) : turned(i, random_direction(random), {0.1, 0, 1});
    const ShapeResult set = ball.set([&](const Vec3& x) { return body.apply(x); });
    ASSERT_TRUE(set) << set.error;
    ball.surface.advance(2 * kFrame);
    ball.surface.advance(2 * kFrame);
    ASSERT_EQ(ball.surface.share(), 1);
    const runtime::View &now = ball.surface.to().view, &then = ball.body.view;
    for (std::uint32_t v = 0; v < then.meta->vertex_count; ++v) {
      ASSERT_LT(distance(vertex(now, v), body.apply(vertex(then, v))), 2e-7) << v;
    }
    const Vec3 p = 0.04 * random_direction(random);
    EXPECT_NEAR(closest_point(now, body.apply(p)).signed_distance, closest_point(then, p).signed_distance, 2e-7);
    const Pose near = runtime::LocalMotion(ball.surface, closest_point(then, p).at).at(1);
    EXPECT_LT(distance(near.apply(p), body.apply(p)), 2e-7);
  }
}

TEST(DeformingSurface, ImpossibleShapeIsRefusedByNameAndTheLastOneStays) {
  Deformed box(box_content(searched()));
  Contact contact(box.body.view, 0);
  const DeformingBody deforming{&box.surface};
  const auto raised = [](const Vec3& x) { return x + Vec3{0, 0, 0.001}; };
  ASSERT_TRUE(box.set(raised));
  Tick good;
  for (double depth = -0.001; depth < 0.002; depth += 1e-5) {
    box.surface.advance(kFrameTick);
    good = contact.tick(upright({0, 0, kTop + 0.001 + kTipRadius - depth}), deforming);
  }
  ASSERT_GT(good.force.z, 0.1);
  const auto expect_refused = [&](const ShapeResult& set, const char* error) {
    EXPECT_FALSE(set);
    EXPECT_EQ(fnmatch(error, set.error, 0), 0) << set.error;
    const std::uint64_t number = box.surface.number();
    for (int i = 0; i < 40; ++i) box.surface.advance(kFrameTick);
    EXPECT_EQ(box.surface.number(), number);
    const Pose pose = upright({0, 0, kTop + 0.001 + kTipRadius - 0.002 + 1e-5});
    EXPECT_NEAR(contact.tick(pose, deforming).force.z, good.force.z, 0.02);
  };
  const std::uint32_t count = box.body.view.meta->site_count;
  ASSERT_TRUE(box.set(raised));
  for (int i = 0; i < 40; ++i) box.surface.advance(kFrameTick);
  expect_refused(box.surface.set(box.sites.data(), count - 1, kFrame), "[0-9]* positions for [0-9]* sites");
  for (const double seconds : {0.0, -1.0, 11.0, std::numeric_limits<double>::quiet_NaN()}) {
    expect_refused(box.set(raised, seconds), "seconds are not in (0, 10]");
  }
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -1e6, 1e300}) {
    const Vec3 third = box.site(3);
    expect_refused(box.set([&](const Vec3& x) {
      return distance(x, third) > 0 ? raised(x) : Vec3{0, wrong, 0};
    }),
                   "site 3: position is not finite, or beyond 1e5 m");
  }
  expect_refused(box.set([](const Vec3& x) {
    return Vec3{x.x, x.y, 0.4 * x.z};
  }),
                 "the patch of sites [0-9, and]* is pressed to less*");
  expect_refused(box.set([](const Vec3& x) {
    return Vec3{1.8 * x.x, x.y, x.z};
  }),
                 "the patch of sites [0-9, and]* is stretched to more*");
  expect_refused(box.set([](const Vec3& x) {
    return Vec3{-x.x, x.y, x.z};
  }),
                 "the body is inside out, or without volume");
  expect_refused(box.set([](const Vec3&) { return Vec3{}; }), "the body is inside out, or without volume");
  // One site of a patch put where its mirror image is.
  const auto& patch = box.body.view.triangle(0).site;
  const Vec3 a = box.site(patch[0]), b = box.site(patch[1]), c = box.site(patch[2]);
  const Vec3 along = unit(b - a, {}), mirrored = c - 2 * tangential(c - a, along);
  expect_refused(box.set([&](const Vec3& x) { return distance(x, c) > 0 ? x : mirrored; }), "the patch of sites *");
}

TEST(DeformingBody, UndeformedBodyHasTheForceOfTheStillOne) {
  for (const Options::Tools tools : {Options::Tools::sphere, Options::Tools::capsule, Options::Tools::mesh}) {
    Options options = searched();
    options.tools = tools;
    Deformed box(box_content(options));
    Contact animated(box.body.view, 0);
  const DeformingBody deforming{&box.surface};
    Contact contact(box.body.view, 0);
    for (int i = 0; i < 3000; ++i) {
      box.surface.advance(kFrameTick);
      const Tick a = contact.tick(probing(1e-3 * i)), b = animated.tick(probing(1e-3 * i), deforming);
      ASSERT_EQ(a.state, b.state) << i;
      // The frame of a deforming body is a pose, whose product with the tool's rounds.
      ASSERT_LT(distance(a.force, b.force), 1e-6 * (1 + length(a.force))) << i;
      ASSERT_LT(distance(a.torque, b.torque), 1e-8) << i;
    }
  }
}

// The surface is where the body was one shape before, along straight lines: off by an eighth of acceleration times the
// square of a shape's time.
TEST(DeformingBody, RigidMotionHasTheForceOfRigidMotion) {
  Deformed box(box_content(searched()));
  Contact animated(box.body.view, 0);
  const DeformingBody deforming{&box.surface};
  Contact moving(box.body.view, 0);
  const auto body = [](double t) {
    return turned(0.4 * std::sin(2 * t), unit(Vec3{1, 2, -1}, {}), {0.02 * std::sin(3 * t), 0.05, 0.01 * t});
  };
  int slid = 0, stuck = 0;
  double most = 0, worst = 0;
  ASSERT_TRUE(box.set([&](const Vec3& x) { return body(0).apply(x); }));
  box.surface.advance(2 * kFrame);
  box.surface.advance(2 * kFrame);
  for (int i = 0; i < 3 / kFrameTick; ++i) {
    const double t = i * kFrameTick;
    if (i % 16 == 0) {
      ASSERT_TRUE(box.set([&](const Vec3& x) { return body(t + kFrame).apply(x); }));
    }
    if (i > 0) box.surface.advance(kFrameTick);
    const Pose tool = body(t) * probing(t);
    const Tick a = moving.tick(tool, RigidMotion{&box.body.view, body(t)}), b = animated.tick(tool, deforming);
    ASSERT_TRUE(std::isfinite(length(b.force) + length(b.torque)));
    most = std::fmax(most, length(a.force));
    worst = std::fmax(worst, distance(a.force, b.force));
    stuck += b.state == State::stick;
    slid += b.state == State::slide;
  }
  EXPECT_GT(stuck, 100);
  EXPECT_GT(slid, 100);
  EXPECT_GT(most, 0.5);
  EXPECT_LT(worst, 0.01 * most);
  RecordProperty("worst", std::to_string(worst / most));
}

// A ball that swells under a tool at rest, and shrinks again.
TEST(DeformingBody, SwellingBodyIsFeltWithoutAStep) {
  Deformed ball(ball_content(searched()));
  Contact contact(ball.body.view, 0);
  const DeformingBody deforming{&ball.surface};
  const Pose tool = upright({0, 0, kBallRadius + kTipRadius + 0.001});
  double most = 0, work = 0, height = kBallRadius;
  Vec3 last;
  bool touched = false;
  constexpr int kFrames = 128;
  for (int i = 0; i < 16 * (kFrames + 4); ++i) {
    if (i % 16 == 0) {
      const double beat = 1 + 0.05 * (1 - std::cos(6.283185307179586 * std::fmin(i / 16, kFrames) / kFrames));
      const ShapeResult set = ball.set([&](const Vec3& x) { return beat * x; });
      ASSERT_TRUE(set) << set.error;
    }
    ball.surface.advance(kFrameTick);
    const Tick tick = contact.tick(tool, deforming);
    // The pole is a vertex of the surface.
    const double before = height;
    height = (1 - ball.surface.share()) * closest_point(ball.surface.from().view, {0, 0, 1}).point.z +
             ball.surface.share() * closest_point(ball.surface.to().view, {0, 0, 1}).point.z;
    if (tick.touches()) {
      ASSERT_LT(distance(tick.force, last), touched ? 3000 * std::fabs(height - before) + 1e-6 : 0.02) << i;
      EXPECT_NEAR(tick.body_point.z, height, 1e-6);
      touched = true;
    }
    work += 0.5 * (tick.force.z + last.z) * (height - before);
    most = std::fmax(most, tick.force.z);
    last = tick.force;
  }
  EXPECT_GT(most, 0.3);
  EXPECT_EQ(length(last), 0);
  EXPECT_NEAR(work, 0, 0.02 * most * 0.002);
}

// On a body stretched to 1.6 times its length the tool has so much further to go to the same place, and friction holds
// it as on the body at rest.
TEST(DeformingBody, ToolSlidesOverTheStretchedSurface) {
  for (const double stretch : {0.6, 1.0, 1.6}) {
    Options options = uniform();
    options.subdivision = 3;
    options.search = true;
    Deformed box(box_content(options));
    const ShapeResult set = box.set([&](const Vec3& x) { return Vec3{stretch * x.x, x.y, x.z}; });
    ASSERT_TRUE(set) << set.error;
    box.surface.advance(2 * kFrame);
    box.surface.advance(2 * kFrame);
    Contact contact(box.body.view, 0);
  const DeformingBody deforming{&box.surface};
    Tick tick;
    for (double depth = -1e-4; depth < 0.002; depth += 1e-5) {
      tick = contact.tick(upright({-0.008 * stretch, 0, kTop + kTipRadius - depth}), deforming);
    }
    const double pressed = tick.force.z;
    for (double way = 0; way < 0.016; way += 2e-5) {
      tick = contact.tick(upright({stretch * (way - 0.008), 0, kTop + kTipRadius - 0.002}), deforming);
    }
    EXPECT_EQ(tick.state, State::slide);
    EXPECT_NEAR(tick.force.z, pressed, 0.02 * pressed) << stretch;
    // The tick is in the frame at the last tick's c, 20 um away.
    EXPECT_NEAR(tick.body_point.x, stretch * position(box.body.view, tick.at).x, 2e-5);
    EXPECT_NEAR(tick.body_point.x, 0.008 * stretch, 0.002) << stretch;
    EXPECT_LT(tick.force.x, -0.5 * tick.friction_limit);
    EXPECT_NEAR(tick.body_point.z, kTop, 1e-6);
  }
}

// The point of the deformed surface that is closest to the tool and c lie apart, and their frames differ.
TEST(DeformingBody, ToolAtRestBeginsWithoutForceInABentBody) {
  Deformed ball(ball_content(searched()));
  for (int k = 0; k < 3; ++k) {
    const ShapeResult set = ball.set([](const Vec3& x) {
      return Vec3{x.x + 4 * x.z * x.z, x.y, 1.2 * x.z + 6 * x.x * x.y};
    });
    ASSERT_TRUE(set) << set.error;
    ball.surface.advance(2 * kFrame);
  }
  for (int i = 0; i < 20; ++i) {
    Contact contact(ball.body.view, 0);
    const double angle = 0.3 * i, out = kBallRadius + kTipRadius - 0.003;
    const Pose tool = upright({out * std::sin(angle), 0.3 * out * std::cos(7 * angle), out * std::cos(angle)});
    EXPECT_EQ(length(contact.tick(tool, DeformingBody{&ball.surface}).force), 0) << i;
    EXPECT_LT(contact.state().energy.energy(), 1e-12) << i;
  }
}

TEST(DeformingBody, WrongPoseIsAFaultAndTheContactBeginsAnew) {
  Deformed box(box_content({}));
  Contact contact(box.body.view, 0);
  const DeformingBody deforming{&box.surface};
  Pose pose = upright({0, 0, kTop + kTipRadius + 0.001});
  for (; pose.translation.z > kTop + kTipRadius - 0.002; pose.translation.z -= 1e-5) contact.tick(pose, deforming);
  EXPECT_GT(length(contact.tick(pose, deforming).force), 0.1);
  Pose wrong = pose;
  wrong.rotation[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(contact.tick(wrong, deforming).state, State::fault);
  EXPECT_EQ(length(contact.tick(pose, deforming).force), 0);  // seen anew, deep inside: without force
  // A tool that is put elsewhere does not push at once either.
  pose.translation = pose.translation + Vec3{0.005, 0.01, 0};
  EXPECT_EQ(length(contact.tick(pose, deforming).force), 0);
}

}  // namespace
}  // namespace palpate::deforming_body_test
