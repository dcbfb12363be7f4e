// SPDX-License-Identifier: GPL-3.0-or-later
// A virtual coupling on bodies that a host serves, scales, carries or shapes.
#include <cmath>
#include <limits>
#include <vector>

#include "tests/runtime/coupling.hpp"
#include "tests/runtime/wandering.hpp"

namespace palpate::coupling_test {
namespace {

Options fine() {
  Options options;
  options.search = true;
  options.subdivision = 3;
  return options;
}

/// A body that takes other shapes, and what a surface needs for it.
struct Shapes : Opened {
  std::vector<double> memory;
  std::vector<Vec3> sites;

  explicit Shapes(ResponseFileContent of)
      : Opened(std::move(of)),
        memory(runtime::AnimatedSurface::bytes(view) / sizeof(double) + 1),
        sites(view.meta->site_count) {}

  /// In 16 ms each site will be where `to` says of where it was baked. False where the surface refuses.
  template <class To>
  bool set(runtime::AnimatedSurface& surface, const To& to) {
    for (std::uint32_t k = 0; k < sites.size(); ++k) sites[k] = to(runtime::to_vec(view.sites[k].position));
    return static_cast<bool>(surface.set(sites.data(), static_cast<std::uint32_t>(sites.size()), 0.016));
  }
};

TEST(CoupledBody, TakesSearchesFromElsewhere) {
  const Opened box(box_content({}));
  Contact served(box.view, 0), alone(box.view, 0);
  VirtualCoupling tie(coupling(300)), other(coupling(300));
  double most = 0;
  for (int i = 0; i < 2000; ++i) {
    const double t = 2e-3 * i;
    const Pose pose = upright({0.003 * std::sin(t), 0, kTop + kTipRadius - 0.003 * std::sin(2 * t)});
    const Vec3 a = tie.tick(served, pose, kTick, runtime::search(box.view, 0, pose)).force;
    const Vec3 b = other.tick(alone, pose, kTick).force;
    ASSERT_LT(distance(a, b), 5e-3) << i;
    most = std::fmax(most, length(a));
  }
  EXPECT_GT(most, 0.1);
}

// Factors that fall and rise while the tool presses and strokes.
TEST(CoupledBody, HoldsAnAdjustedContact) {
  const Opened box(box_content({}));
  std::vector<runtime::SiteScales::Scale> memory(box.view.meta->site_count);
  runtime::SiteScales scales(box.view, memory.data());
  for (const double stiffness : {150.0, 1e8}) {
    runtime::AdjustedContact contact(box.view, 0, scales), plain(box.view, 0, scales);
    VirtualCoupling tie(coupling(stiffness));
    Wandering wandering(12);
    std::mt19937 random(12);
    Loops loops;
    double least = 1, most = 1;
    for (int i = 0; i < 20000; ++i) {
      if (i % 100 == 0) {
        const auto site = static_cast<std::uint32_t>(random() % box.view.meta->site_count);
        scales.set(site, 1e-3f * static_cast<float>(random() % 2000));
      }
      const Pose pose = upright(wandering.next().translation);
      const Vec3 force = tie.tick(contact, pose, kTick, kTick).force, stiff = plain.tick(pose, kTick).force;
      loops.add(pose.translation, force);
      ASSERT_TRUE(stiffness < 1e6 || distance(force, stiff) < 2e-3 * length(stiff) + 2e-3) << i;
      least = std::fmin(least, contact.scale());
      most = std::fmax(most, contact.scale());
    }
    EXPECT_GT(loops.touches, 20);
    EXPECT_GT(loops.taken, 1e-3);
    EXPECT_LT(loops.given, 1e-5) << stiffness;
    EXPECT_LT(least, 0.5);
    EXPECT_GT(most, 1.5);
  }
}

// A body that is carried in and out under tools that go over it: only how they move against it is felt, and pays.
TEST(CoupledBody, HoldsAToolAgainstABodyThatMoves) {
  Shapes box(box_content(fine()));
  const auto carry = [](double t) { return Vec3{0.004 * std::sin(5 * t), 0, 0.003 * std::sin(7 * t)}; };
  for (const double stiffness : {150.0, 1e8}) {
    runtime::AnimatedSurface surface(box.view, box.memory.data());
    runtime::AnimatedContact contact(surface, 0), plain(surface, 0);
    Contact rest(box.view, 0);
    VirtualCoupling tie(coupling(stiffness)), tie_at_rest(coupling(stiffness));
    Loops loops;
    double most = 0, apart = 0;
    for (int i = 0; i < 12000; ++i) {
      // Shapes 16 ms apart, between which the body goes straight.
      const double now = 1e-3 * (i % 16), from = 1e-3 * (i - i % 16);
      const Vec3 body = i == 0 ? Vec3{} : carry(from) + (now / 0.016) * (carry(from + 0.016) - carry(from));
      if (i % 16 == 0) {
        ASSERT_TRUE(box.set(surface, [&](const Vec3& site) { return site + carry(from + 0.016); }));
      }
      if (i > 0) surface.advance(kTick);
      Pose tool = probing(kTick * i);  // against the body
      const Vec3 at = tool.translation;
      const Vec3 at_rest = tie_at_rest.tick(rest, tool, kTick).force;
      tool.translation = at + body;
      const Vec3 force = tie.tick(contact, tool, kTick).force, stiff = plain.tick(tool).force;
      loops.add(at, force);
      most = std::fmax(most, length(force));
      apart = std::fmax(apart, distance(force, at_rest));
      ASSERT_TRUE(stiffness < 1e6 || distance(force, stiff) < 2e-3 * length(stiff) + 2e-3) << i;
    }
    EXPECT_GT(most, stiffness > 1e6 ? 0.5 : 0.2);
    EXPECT_LT(apart, 0.01 * most) << stiffness;
    EXPECT_GE(loops.touches, 3);
    EXPECT_GT(loops.taken, 1e-4);
    EXPECT_LT(loops.given, 1e-5) << stiffness;
  }
}

// It comes to a tool that is held still: the hand feels it in series with the spring, and gives and gets nothing.
TEST(CoupledBody, FeelsABodyThatSwells) {
  Shapes ball(ball_content(fine()));
  const Pose tool = upright({0, 0, kBallRadius + kTipRadius + 0.001});
  double plain_most = 0;
  for (const double stiffness : {1e8, 200.0}) {
    runtime::AnimatedSurface surface(ball.view, ball.memory.data());
    runtime::AnimatedContact contact(surface, 0), plain(surface, 0);
    VirtualCoupling tie(coupling(stiffness));
    double most = 0, work = 0, height = 0;
    Vec3 last;
    for (int i = 0; i < 16 * 132; ++i) {
      if (i % 16 == 0) {
        const double beat = 1 + 0.05 * (1 - std::cos(6.283185307179586 * std::fmin(i / 16, 128) / 128));
        ASSERT_TRUE(ball.set(surface, [&](const Vec3& site) { return beat * site; }));
      }
      surface.advance(kTick);
      const double before = height, share = surface.share();
      height = (1 - share) * locate(surface.from().view, {0, 0, 1}).point.z +
               share * locate(surface.to().view, {0, 0, 1}).point.z;
      const Vec3 force = tie.tick(contact, tool, kTick).force;
      work += i > 0 ? 0.5 * (force.z + last.z) * (height - before) : 0;
      most = std::fmax(most, force.z);
      if (stiffness > 1e6) plain_most = std::fmax(plain_most, plain.tick(tool).force.z);
      last = force;
    }
    EXPECT_EQ(length(last), 0);
    EXPECT_GE(work, -0.02 * most * 0.002);
    if (stiffness > 1e6) {
      EXPECT_GT(plain_most, 0.3);
      EXPECT_NEAR(most, plain_most, 2e-3 * plain_most);
    } else {
      // The spring takes its share of the body's 9 mm beyond the first touch.
      EXPECT_GT(most, 0.25 * plain_most);
      EXPECT_LT(most, 0.6 * plain_most);
    }
  }
}

// In the body's frame, as MovingContact says: the same as on the body at rest.
TEST(CoupledBody, HoldsAToolOnABodyThatTurns) {
  const Opened box(box_content({}));
  Contact contact(box.view, 0), rest(box.view, 0);
  VirtualCoupling tie(coupling(200, 0.1)), tie_at_rest(coupling(200, 0.1));
  double most = 0;
  for (int i = 0; i < 3000; ++i) {
    const double t = kTick * i;
    const Pose body = turned(0.4 * std::sin(3 * t), unit(Vec3{1, 2, -1}, {}), {0.02 * std::sin(7 * t), 0.5, 0.01 * t});
    const Tick there = carried(body, tie.tick(contact, runtime::seen_from(body, body * probing(t)), kTick));
    const Vec3 force = tie_at_rest.tick(rest, probing(t), kTick).force;
    ASSERT_LT(distance(there.force, body.rotate(force)), 1e-6 * (1 + length(force))) << i;
    most = std::fmax(most, length(force));
  }
  EXPECT_GT(most, 0.1);
  Pose none;
  none.rotation[4] = std::numeric_limits<double>::quiet_NaN();
  const Tick fault = carried(none, tie.tick(contact, runtime::seen_from(none, probing(0)), kTick));
  EXPECT_EQ(fault.state, State::fault);
  EXPECT_EQ(length(fault.force), 0);
}

// A sample that comes twice: no time went by, so nothing did; but a clock that stands still holds no force.
TEST(CoupledBody, GivesTheLastTickAgainWhereNoTimeWentBy) {
  const Opened box(box_content({}));
  Contact once(box.view, 0), twice(box.view, 0);
  VirtualCoupling tie(coupling(200, 0.1)), same(tie);
  Tick tick;
  for (int i = 0; i < 4000; ++i) {
    const Pose pose = probing(kTick * i);
    tick = same.tick(twice, pose, kTick);
    const Tick expected = tie.tick(once, pose, kTick);
    ASSERT_EQ(distance(tick.force, expected.force), 0) << i;
    for (int again = 0; again < i % 4; ++again) {
      const Tick repeated = same.tick(twice, pose, 0);
      ASSERT_EQ(repeated.state, expected.state) << i;
      ASSERT_EQ(distance(repeated.force, expected.force) + distance(repeated.torque, expected.torque), 0) << i;
    }
  }
  const Pose pressed = upright({0, 0, kTop + kTipRadius - 0.002});
  for (int i = 0; i < 300; ++i) tick = same.tick(twice, upright({0, 0, kTop + kTipRadius + 0.001 - 1e-5 * i}), kTick);
  EXPECT_GT(length(tick.force), 0.1);
  int held = 0;
  while (length(same.tick(twice, pressed, 0).force) > 0 && held < 100) ++held;
  EXPECT_EQ(held, same.kRepeats);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(same.tick(twice, pressed, 0).state, State::fault);
  EXPECT_EQ(length(same.tick(twice, pressed, kTick).force), 0) << "forgotten";
  VirtualCoupling fresh(coupling(200));
  EXPECT_EQ(length(fresh.tick(once, pressed, 0).force), 0);
}

// Whoever asks a tick whether it touches must not take the spring's force for none.
TEST(CoupledBody, SaysThatItSticksWhileItHoldsTheHand) {
  Options options;
  options.tools = Options::Tools::mesh;
  options.search = true;
  const Opened box(box_content(options));
  CouplingOptions hasty = coupling(2000);
  hasty.trials = 2;
  Contact contact(box.view, 0);
  VirtualCoupling tie(hasty);
  std::mt19937 random(17);
  int off = 0;
  const double high = runtime::skeleton_radius(box.view, 0) + 0.001;
  for (int stroke = 0; stroke < 80; ++stroke) {
    const Vec3 turn = random_direction(random), way = 5e-4 * random_direction(random);
    Pose pose = turned(3 * turn.x, random_direction(random), {0.01 * turn.y, 0.01 * turn.z, kTop + high});
    contact.reset();
    tie.reset();
    for (int i = 0; i < 60; ++i) {
      pose.translation = pose.translation + (i < 30 ? 1 : -1) * Vec3{way.x, way.y, -std::fabs(way.z) - 1e-4};
      const Tick tick = tie.tick(contact, pose, kTick);
      if (!(length(tick.force) > 0)) continue;
      ASSERT_TRUE(tick.touches()) << stroke << ' ' << i;
      EXPECT_LT(std::fabs(runtime::locate(box.view, tick.body_point).signed_distance), 1e-6);
      off += tick.depth == 0;
      if (tick.depth == 0) {
        ASSERT_EQ(length(tick.torque) + tick.friction_limit, 0);
      }
    }
  }
  EXPECT_GT(off, 10);
}

}  // namespace
}  // namespace palpate::coupling_test
