// SPDX-License-Identifier: GPL-3.0-or-later
// Searches, shapes and factors at a low rate, forces at a high one: in one thread step by step, and in two that race
// (built with the thread sanitizer).
#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "tests/runtime/two_lobes.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;
using runtime::Latest;
using runtime::Places;
using runtime::Search;
using runtime::SeveralContacts;
using runtime::SeveralSearch;
using runtime::SeveralTick;

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
  constexpr int kFar = 20000, kOften = 1000;
  Latest<Value> box;
  std::atomic<bool> enough{false};  // on a busy machine either thread may run alone for long
  std::thread writer([&] {
    Value value;
    for (int i = 1; !enough; ++i) {
      for (int& part : value.parts) part = i;
      box.write(value);
    }
  });
  int before = 0, reads = 0;
  while (before < kFar || reads < kOften) {
    Value value;
    if (!box.read(value)) continue;
    ++reads;
    EXPECT_GT(value.parts[0], before);
    for (const int part : value.parts) EXPECT_EQ(part, value.parts[0]);
    before = value.parts[0];
  }
  enough = true;
  writer.join();
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

// So it is for a body that moves, one whose factors change, and several tools.
TEST(TwoRates, FreshSearchesGiveTheSameForcesOfEveryKind) {
  const Opened ball(ball_content({}));
  runtime::MovingContact moving(ball.view, 0), served_moving(ball.view, 0);
  std::vector<runtime::SiteScales::Scale> factors(ball.view.meta->site_count);
  runtime::SiteScales scales(ball.view, factors.data());
  runtime::AdjustedContact adjusted(ball.view, 0, scales), served_adjusted(ball.view, 0, scales);
  runtime::SeveralTools<2> tools(ball.view, {0, 0}), served_tools(ball.view, {0, 0});
  std::mt19937 random(5);
  int touched = 0;
  for (double t = 0; t < 4; t += kTick) {
    const Pose body = turned(0.4 * std::sin(3 * t), unit(Vec3{1, 2, -1}, {}), {0.02 * std::sin(7 * t), 0.5, 0.01 * t});
    const Pose pose = dipping(t), tool = body * pose, other = dipping(t + 0.3);
    scales.set(static_cast<std::uint32_t>(random() % factors.size()), 0.5F + static_cast<float>(random() % 100) / 50);
    const Search latest = runtime::search(ball.view, 0, pose);
    const auto pair = tools.tick({pose, other});
    const auto served_pair = served_tools.tick({pose, other}, {latest, runtime::search(ball.view, 0, other)});
    const Tick alone[] = {moving.tick(body, tool), adjusted.tick(pose, kTick), pair[0], pair[1]};
    const Tick served[] = {served_moving.tick(body, tool, runtime::search(ball.view, 0, body, tool)),
                           served_adjusted.tick(pose, kTick, latest), served_pair[0], served_pair[1]};
    for (std::size_t k = 0; k < 4; ++k) {
      ASSERT_EQ(alone[k].state, served[k].state) << k << ' ' << t;
      ASSERT_EQ(distance(alone[k].force, served[k].force), 0) << k << ' ' << t;
      touched += served[k].touches();
    }
    ASSERT_EQ(tools.overlap().error, served_tools.overlap().error);
  }
  EXPECT_GT(touched, 1000);
}

// The tracker's poses are of one time: how the body went on since is motion of the tool against it.
TEST(TwoRates, StaleSearchesOfAMovingBodyLoseLittle) {
  Options options;
  options.subdivision = 3;
  const Opened ball(ball_content(options));
  runtime::MovingContact alone(ball.view, 0), served(ball.view, 0);
  Search latest, coming;
  double most = 0, worst = 0;
  int tick = 0;
  for (double t = 0; t < 8; t += kTick, ++tick) {
    const Pose body = turned(0.2 * std::sin(2 * t), {0, 0, 1}, {0.01 * std::sin(3 * t), 0, 0}),
               tool = body * dipping(t);
    if (tick % 40 == 0) {
      latest = tick > 0 ? coming : runtime::search(ball.view, 0, body, tool);
      coming = runtime::search(ball.view, 0, body, tool);
    }
    const Tick a = alone.tick(body, tool), b = served.tick(body, tool, latest);
    most = std::fmax(most, length(a.force));
    worst = std::fmax(worst, distance(a.force, b.force));
  }
  EXPECT_GT(most, 0.3);
  EXPECT_LT(worst, 0.05 * most);
  EXPECT_EQ(served.tick(Pose{{}, {}}, Pose(), latest).state, State::fault);
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

// Deep in a box and round its edge: c leaps towards the other side, in a tick of a long way to where the search saw it,
// and never by one of its own.
TEST(TwoRates, AServedContactNeverSearches) {
  Options options = uniform();
  options.lateral = options.friction = false;
  options.subdivision = 3;
  options.search = true;
  const Opened box(box_content(options));
  const Trap trap(box.view);
  ASSERT_NE(box.view.search, nullptr);
  // c waits where it would turn the force by more than by the tool's way, and goes on by parts of the way as it can.
  const struct {
    double depth, stride;
    std::size_t searched;
  } kRows[] = {{0.012, 2e-6, 0}, {0.013, 2e-6, 0}, {0.012, 3e-4, 0}, {0.013, 3e-4, 0}, {0.013, 1e-3, 1}};
  for (const auto& [depth, stride, searched] : kRows) {
    Contact alone(box.view, 0), served(box.view, 0), trapped(trap.view, 0), searching(trap.view, 0), stale(box.view, 0);
    Served searches{box.view, {}, {}};
    const Search old = runtime::search(box.view, 0, upright({0, 0, kTop + kTipRadius + 0.001}));
    Tick last_alone, last, last_stale;
    std::size_t leaps = 0, leaps_alone = 0, leaps_stale = 0, fell = 0;
    std::vector<double> apart;
    const auto leapt = [far = 1e-3 + 1.5 * stride](const Tick& tick, Tick& before) {
      const bool touched = before.state == State::slide && tick.state == State::slide;
      const bool leap = touched && distance(tick.body_point, before.body_point) > far;
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
      apart.push_back(distance(a.force, b.force));
    };
    for (double in = -0.001; in < depth; in += 1e-5) go({0.015, 0, kTop + kTipRadius - in}, 0.1);
    const double pressed = length(last.force);
    for (double x = 0.015; x < 0.035; x += stride) go({x, 0, kTop + kTipRadius - depth}, 3000 * 2 * stride);
    EXPECT_GE(leaps_alone, 1) << depth;
    EXPECT_LE(leaps_alone, 6) << depth << " " << stride;
    EXPECT_EQ(leaps, leaps_alone) << depth << " " << stride;
    EXPECT_EQ(fell, searched) << "one that searches is caught";
    EXPECT_LE(leaps_stale, leaps - searched) << "a search of another place says nothing";
    // A fast one, whose searches are old, may leap two ticks later than one that searches itself.
    std::sort(apart.rbegin(), apart.rend());
    EXPECT_LT(apart[stride > 1e-5 ? 2 : 0], 0.05 * pressed) << depth << " " << stride;
  }
}

/// Down between two lobes, to and fro, and out, at up to 0.05 m/s.
Pose between_lobes(double t) {
  const double depth = 0.002 * (1 - std::cos(8 * t)) - 0.001;
  return upright({0.0015 * std::sin(5 * t), 0.002 * std::sin(3 * t), between() - depth});
}

// Other places are looked for by the tracker, too: both lobes push as if the loop had looked, and nothing tears.
TEST(TwoRates, AServedToolTouchesBothLobesAndNeverLooks) {
  for (const bool friction : {false, true}) {
    const Opened body(two_lobes(smooth(friction)));
    const Trap trap(body.view);
    for (const int every : {1, 5, 40}) {
      SeveralContacts<> alone(body.view, 0), served(body.view, 0), trapped(trap.view, 0);
      Places<2> places;
      SeveralSearch<2> latest, coming;
      Vec3 last;
      Vec3 seen_at;
      double most = 0, worst = 0, largest = 0;
      int twice = 0, tick = 0;
      for (double t = 0; t < 4; t += kTick, ++tick) {
        const Pose pose = between_lobes(t);
        places.pose = pose;
        if (tick % every == 0) {
          latest = tick > 0 ? coming : runtime::search(body.view, 0, places);
          coming = runtime::search(body.view, 0, places);
        }
        const SeveralTick<2> a = alone.tick(pose), b = served.tick(pose, latest), c = trapped.tick(pose, latest);
        places = Places<2>::of(pose, b);
        ASSERT_EQ(b.touching, c.touching) << t;
        ASSERT_EQ(distance(b.force, c.force) + distance(b.torque, c.torque), 0) << t;
        largest = std::fmax(largest, distance(b.force, last) / (1e-9 + distance(pose.translation, seen_at)));
        last = b.force;
        seen_at = pose.translation;
        most = std::fmax(most, length(a.force));
        worst = std::fmax(worst, distance(a.force, b.force));
        twice += b.touching == 2;
      }
      EXPECT_GT(twice, 400);
      EXPECT_LT(largest, 2 * 3000) << every << ' ' << friction;  // N/m, above any slope of two sample curves
      EXPECT_LT(worst, (every > 5 ? 0.15 : 0.03) * most) << every << ' ' << friction;
    }
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

TEST(TwoRates, AThreadLooksForOtherPlacesWhileAnotherMakesForces) {
  const Opened body(two_lobes(smooth(true)));
  Latest<Places<2>> asked;
  Latest<SeveralSearch<2>> searches;
  std::atomic<bool> stop{false};
  std::thread searcher([&] {
    Places<2> places;
    while (!stop.load(std::memory_order_relaxed)) {
      if (asked.read(places)) searches.write(runtime::search(body.view, 0, places));
      std::this_thread::yield();
    }
  });
  SeveralContacts<> contact(body.view, 0);
  Places<2> places;
  places.pose = between_lobes(0);
  SeveralSearch<2> latest = runtime::search(body.view, 0, places);
  int twice = 0;
  for (double t = 0; t < 2; t += 0.5 * kTick) {
    const SeveralTick<2> tick = contact.tick(between_lobes(t), latest);
    asked.write(Places<2>::of(between_lobes(t), tick));
    searches.read(latest);
    ASSERT_TRUE(std::isfinite(length(tick.force)));
    ASSERT_LT(length(tick.force), 4 * kHertzForce);
    twice += tick.touching == 2;
    std::this_thread::yield();
  }
  stop = true;
  searcher.join();
  EXPECT_GT(twice, 100);
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
