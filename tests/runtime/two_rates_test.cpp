// SPDX-License-Identifier: GPL-3.0-or-later
// Searches, shapes and factors at a low rate, forces at a high one: in one thread step by step, and in two that race
// (built with the thread sanitizer).
#include <atomic>
#include <cmath>
#include <random>
#include <thread>
#include <vector>

#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;
using runtime::Latest;
using runtime::Search;

constexpr double kTick = 1e-3;  // s

// A tip that dips into the ball's upper side, each time elsewhere, at up to 0.1 m/s.
Pose dipping(double t) {
  const double angle = 0.8 * std::sin(1.7 * t), way = kBallRadius + kTipRadius + 0.004 - 0.006 * std::sin(11 * t);
  return upright({way * std::sin(angle), 0.2 * way * std::sin(3 * t), way * std::cos(angle)});
}

TEST(Latest, IsReadOnceAndNeverGoesBack) {
  Latest<int> box;
  int value = -1;
  EXPECT_FALSE(box.read(value));
  EXPECT_EQ(value, -1);
  box.write(1);
  EXPECT_TRUE(box.read(value));
  EXPECT_FALSE(box.read(value));
  EXPECT_EQ(value, 1);
  for (int i = 2; i < 10; ++i) box.write(i);
  EXPECT_TRUE(box.read(value));
  EXPECT_EQ(value, 9);
}

// Whole values only: all of a value's numbers are of one writing.
TEST(Latest, IsNeverTornBetweenThreads) {
  struct Value {
    int parts[40] = {};
  };
  constexpr int kLast = 20000;
  Latest<Value> box;
  std::thread writer([&] {
    Value value;
    for (int i = 1; i <= kLast; ++i) {
      for (int& part : value.parts) part = i;
      box.write(value);
    }
  });
  int before = 0, reads = 0;
  while (before < kLast) {
    Value value;
    if (!box.read(value)) continue;
    ++reads;
    ASSERT_GT(value.parts[0], before);
    for (const int part : value.parts) ASSERT_EQ(part, value.parts[0]);
    before = value.parts[0];
  }
  writer.join();
  EXPECT_GT(reads, 1);
}

// A search of every tick is the contact that searches for itself.
TEST(TwoRates, FreshSearchesGiveTheSameForces) {
  const Opened ball(ball_content({}));
  Contact alone(ball.view, 0), served(ball.view, 0);
  for (double t = 0; t < 4; t += kTick) {
    const Pose pose = dipping(t);
    const Tick a = alone.tick(pose), b = served.tick(pose, runtime::search(ball.view, 0, pose));
    ASSERT_EQ(a.state, b.state) << t;
    ASSERT_EQ(distance(a.force, b.force), 0) << t;
  }
}

// Searches that are 5 to 40 ticks old: contacts begin where the surface near the old nearest point is met.
TEST(TwoRates, StaleSearchesLoseLittleAndNeverBeginWithAForce) {
  Options options;
  options.subdivision = 3;
  const Opened ball(ball_content(options));
  for (const int every : {5, 40}) {
    Contact alone(ball.view, 0), served(ball.view, 0);
    Search latest = runtime::search(ball.view, 0, dipping(0)), coming = latest;
    double most = 0, worst = 0;
    bool touched = false;
    int contacts = 0, tick = 0;
    for (double t = 0; t < 8; t += kTick, ++tick) {
      const Pose pose = dipping(t);
      if (tick % every == 0) {  // what was searched for one period ago arrives
        latest = coming;
        coming = runtime::search(ball.view, 0, pose);
      }
      const Tick a = alone.tick(pose), b = served.tick(pose, latest);
      const bool touches = b.state == State::stick || b.state == State::slide;
      if (touches && !touched) {
        ++contacts;
        ASSERT_LT(length(b.force), 0.02) << every << " " << t;
      }
      touched = touches;
      most = std::fmax(most, length(a.force));
      worst = std::fmax(worst, distance(a.force, b.force));
    }
    EXPECT_GT(contacts, 10);
    EXPECT_GT(most, 0.3);
    EXPECT_LT(worst, 0.05 * most) << every;
  }
}

// A search that has stopped, and a body met elsewhere meanwhile: nothing is felt until a search sees it, then no jump.
TEST(TwoRates, ABodyMetBehindAStoppedSearchBeginsAtZero) {
  const Opened box(box_content(uniform()));
  Contact contact(box.view, 0);
  const double beside = kBoxSize / 2 + kTipRadius;
  const Search stopped = runtime::search(box.view, 0, upright({beside + 0.01, 0, 0}));
  // Round to the top and into it, far from the side that the search saw.
  for (double x = beside + 0.01; x > 0; x -= 1e-4) {
    EXPECT_EQ(length(contact.tick(upright({x, 0, kTop + kTipRadius + 0.02}), stopped).force), 0);
  }
  Pose pose = upright({0, 0, kTop + kTipRadius});
  for (; pose.translation.z > kTop + kTipRadius - 0.002; pose.translation.z -= 1e-5) {
    EXPECT_EQ(length(contact.tick(pose, stopped).force), 0);
  }
  const Tick seen = contact.tick(pose, runtime::search(box.view, 0, pose));
  EXPECT_LT(length(seen.force), 0.02);
}

/// The view of a body whose search tree is a trap: whoever searches there finds the same triangle always.
struct Trap {
  runtime::View view;
  layout::SearchNode leaf{};
  explicit Trap(const runtime::View& good) : view(good) {
    leaf.count = 1;
    view.search = &leaf;
  }
  Trap(const Trap&) = delete;
  Trap& operator=(const Trap&) = delete;
};

/// Searches of a body that come every 5 ticks, of the pose 5 ticks before.
struct Served {
  const runtime::View& view;
  Search latest, coming;
  int ticks = 0;
  const Search& at(const Pose& pose) {
    if (ticks++ % 5 == 0) {
      latest = ticks == 1 ? runtime::search(view, 0, pose) : coming;
      coming = runtime::search(view, 0, pose);
    }
    return latest;
  }
};

// Deep in a box and round its edge: c leaps to the other side, where the search saw it and not by one of its own.
TEST(TwoRates, AServedContactNeverSearches) {
  Options options = uniform();
  options.lateral = options.friction = false;
  options.subdivision = 3;
  options.search = true;
  const Opened box(box_content(options));
  const Trap trap(box.view);
  ASSERT_NE(box.view.search, nullptr);
  for (const double depth : {0.012, 0.013}) {
    Contact alone(box.view, 0), served(box.view, 0), trapped(trap.view, 0), searching(trap.view, 0), stale(box.view, 0);
    Served searches{box.view, {}, {}};
    const Search old = runtime::search(box.view, 0, upright({0, 0, kTop + kTipRadius + 0.001}));
    Tick last_alone, last, last_stale;
    int leaps = 0, leaps_alone = 0, leaps_stale = 0, fell = 0;
    double apart = 0;
    const auto leapt = [](const Tick& tick, Tick& before) {
      const bool touched = before.state == State::slide && tick.state == State::slide;
      const bool leap = touched && distance(tick.body_point, before.body_point) > 1e-3;
      before = tick;
      return leap;
    };
    const auto go = [&](const Vec3& at, double most) {
      const Pose pose = upright(at);
      const Search& latest = searches.at(pose);
      const Tick a = alone.tick(pose), b = served.tick(pose, latest), t = trapped.tick(pose, latest);
      ASSERT_EQ(b.state, t.state) << at.x;
      ASSERT_EQ(distance(b.force, t.force) + distance(b.body_point, t.body_point), 0) << at.x;
      ASSERT_LT(length(b.force), length(last.force) + most) << at.x;
      const bool leap = leapt(a, last_alone);
      const bool stale_leapt = leapt(stale.tick(pose, old), last_stale);
      const Tick s = searching.tick_found(pose, latest);
      if (leap) fell += distance(s.body_point, a.body_point) > 1e-3;
      leaps_alone += leap;
      leaps_stale += leap && stale_leapt;
      leaps += leapt(b, last);
      apart = std::fmax(apart, distance(a.force, b.force));
    };
    for (double in = -0.001; in < depth; in += 1e-5) go({0, 0, kTop + kTipRadius - in}, 0.1);
    const double pressed = length(last.force);
    for (double x = 0; x < 0.04; x += 2e-6) go({x, 0, kTop + kTipRadius - depth}, 3000 * 2 * 2e-6);
    EXPECT_EQ(leaps_alone, 1) << depth;
    EXPECT_EQ(leaps, 1) << depth;
    EXPECT_EQ(fell, 1) << "one that searches is caught";
    EXPECT_EQ(leaps_stale, 0) << "a search of another place says nothing";
    EXPECT_LT(apart, 0.05 * pressed) << depth;
  }
}

// The real thing: a thread that searches, and a loop that only makes forces.
TEST(TwoRates, AThreadSearchesWhileAnotherMakesForces) {
  const Opened ball(ball_content({}));
  Latest<Pose> poses;
  Latest<Search> searches;
  std::atomic<bool> stop{false};
  std::thread searcher([&] {
    Pose pose;
    while (!stop.load(std::memory_order_relaxed)) {
      if (poses.read(pose)) searches.write(runtime::search(ball.view, 0, pose));
      std::this_thread::yield();
    }
  });
  Contact contact(ball.view, 0);
  Search latest = runtime::search(ball.view, 0, dipping(0));
  double most = 0;
  int answered = 0;
  for (double t = 0; t < 4; t += kTick) {
    const Pose pose = dipping(t);
    poses.write(pose);
    answered += searches.read(latest);
    const Tick tick = contact.tick(pose, latest);
    ASSERT_TRUE(std::isfinite(length(tick.force)));
    ASSERT_LT(length(tick.force), 2 * kHertzForce);
    most = std::fmax(most, length(tick.force));
    std::this_thread::yield();
  }
  stop = true;
  searcher.join();
  EXPECT_GT(answered, 10);
  EXPECT_GT(most, 0.1);
}

// Shapes come from a thread of their own; every tick lies between two whole ones.
TEST(TwoRates, AThreadGivesShapesWhileAnotherMakesForces) {
  const Opened ball(ball_content({}));
  std::vector<double> memory(runtime::AnimatedSurface::bytes(ball.view) / sizeof(double) + 1);
  runtime::AnimatedSurface surface(ball.view, memory.data());
  std::atomic<bool> stop{false};
  std::atomic<int> refused{0};
  std::thread host([&] {
    std::vector<Vec3> sites(ball.view.meta->site_count);
    for (int shape = 0; !stop.load(std::memory_order_relaxed); ++shape) {
      const double size = 1 + 0.05 * std::sin(0.2 * shape);
      for (std::uint32_t i = 0; i < sites.size(); ++i) sites[i] = size * runtime::to_vec(ball.view.sites[i].position);
      refused += !surface.set(sites.data(), ball.view.meta->site_count, 5 * kTick);
      std::this_thread::yield();
    }
  });
  runtime::AnimatedContact contact(surface, 0);
  double most = 0;
  for (double t = 0; t < 4; t += kTick) {
    surface.advance(kTick);
    const Tick tick = contact.tick(dipping(t));
    ASSERT_TRUE(std::isfinite(length(tick.force)));
    ASSERT_LT(length(tick.force), 4 * kHertzForce);
    most = std::fmax(most, length(tick.force));
    std::this_thread::yield();
  }
  stop = true;
  host.join();
  EXPECT_EQ(refused, 0);
  EXPECT_GT(surface.number(), 10U);
  EXPECT_GT(most, 0.1);
}

// Factors come from a thread of their own; every tick's force is between those of whole factors, and what fell stays.
TEST(TwoRates, AThreadGivesFactorsWhileAnotherMakesForces) {
  constexpr double kRate = 5;  // 1/s
  const Opened box(box_content(uniform()));
  std::vector<runtime::SiteScales::Scale> memory(box.view.meta->site_count);
  runtime::SiteScales scales(box.view, memory.data());
  std::atomic<bool> done{false};
  std::thread writer([&] {
    std::mt19937 random(3);
    while (!done.load()) {
      scales.set(static_cast<std::uint32_t>(random() % box.view.meta->site_count),
                 static_cast<float>(random() % 200) / 100);
      std::this_thread::yield();
    }
  });
  runtime::AdjustedContact contact(box.view, 0, scales, kRate);
  const auto pressed = [&](double depth) {
    return length(contact.tick(upright({0.004, 0.002, kTop + kTipRadius - depth}), kTick).force);
  };
  pressed(-0.001);
  for (int k = 0; k <= 100; ++k) pressed(3e-5 * k);
  double last = pressed(0.003);
  bool good = true;
  for (int k = 0; good && k < 20000; ++k) {
    const double force = pressed(0.003);
    good = force >= 0 && force <= last * (1 + 1e-12) && last - force <= 3 * kRate * kTick * hertz(0.003);
    last = force;
  }
  done = true;
  writer.join();
  EXPECT_TRUE(good);
}

}  // namespace
}  // namespace palpate
