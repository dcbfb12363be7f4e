// SPDX-License-Identifier: GPL-3.0-or-later
// Searches, shapes and factors at a low rate, forces at a high one: in one thread step by step, and in two that race
// (built with the thread sanitizer).
#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <thread>
#include <vector>

#include "tests/runtime/two_lobes.hpp"

namespace palpate::two_rates_test {
namespace {

using namespace test;
using runtime::Contact;
using runtime::ContactSet;
using runtime::DeformingBody;
using runtime::DeformingSurface;
using runtime::RigidMotion;
using runtime::Search;
using runtime::SetSearch;
using runtime::SiteScales;
using runtime::StiffnessScale;
using runtime::StillBody;
using runtime::TripleBuffer;
using runtime::WallSearchRequest;

constexpr double kTick = 1e-3;  // s

// A tip that dips into the ball's upper side, each time elsewhere, at up to 0.1 m/s.
Pose dipping(double t) {
  const double angle = 0.8 * std::sin(1.7 * t), way = kBallRadius + kTipRadius + 0.004 - 0.006 * std::sin(11 * t);
  return upright({way * std::sin(angle), 0.2 * way * std::sin(3 * t), way * std::cos(angle)});
}

TEST(TwoRates, SearchOfEveryTickGivesTheSameForces) {
  const Opened ball(ball_content({}));
  std::vector<SiteScales::Scale> memory(ball.view.meta->site_count);
  SiteScales scales(ball.view, memory.data());
  const StiffnessScale<StillBody> scaled{{&ball.view}, &scales, &ball.view};
  Contact alone[3] = {{ball.view, 0}, {ball.view, 0}, {ball.view, 0}}, searched[3] = {alone[0], alone[1], alone[2]};
  std::mt19937 random(5);
  int touched = 0;
  for (double t = 0; t < 4; t += kTick) {
    const Pose frame = turned(0.4 * std::sin(3 * t), unit(Vec3{1, 2, -1}, {}), {0.02 * std::sin(7 * t), 0.5, 0.01 * t});
    const Pose pose = dipping(t);
    const RigidMotion moving{&ball.view, frame};
    scales.set(static_cast<std::uint32_t>(random() % memory.size()), 0.5F + static_cast<float>(random() % 100) / 50);
    const Search latest = runtime::search(ball.view, 0, pose);
    const Tick a[] = {alone[0].tick(pose), alone[1].tick(frame * pose, moving), alone[2].tick(pose, scaled)};
    const Tick b[] = {searched[0].tick(pose, latest), searched[1].tick(frame * pose, moving, &latest),
                      searched[2].tick(pose, scaled, &latest)};
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(a[k].touches(), b[k].touches()) << k << ' ' << t;
      ASSERT_LT(distance(a[k].force, b[k].force), 1e-6 * (1 + length(a[k].force))) << k << ' ' << t;
      touched += b[k].touches();
    }
  }
  EXPECT_GT(touched, 1000);
}

// Searches that are 5 to 40 ticks old.
TEST(TwoRates, OldSearchesLoseLittleAndNeverBeginWithAForce) {
  Options options;
  options.subdivision = 3;
  const Opened ball(ball_content(options));
  for (const int every : {5, 40}) {
    Contact alone(ball.view, 0), searched(ball.view, 0);
    Search latest = runtime::search(ball.view, 0, dipping(0)), coming = latest;
    double most = 0, worst = 0;
    bool touched = false;
    int contacts = 0, tick = 0;
    for (double t = 0; t < 8; t += kTick, ++tick) {
      const Pose pose = dipping(t);
      if (tick % every == 0) {  // the search of one period ago arrives
        latest = coming;
        coming = runtime::search(ball.view, 0, pose);
      }
      const Tick a = alone.tick(pose), b = searched.tick(pose, latest);
      if (b.touches() && !touched) {
        ++contacts;
        ASSERT_LT(length(b.force), 0.02) << every << " " << t;
      }
      touched = b.touches();
      most = std::fmax(most, length(a.force));
      worst = std::fmax(worst, distance(a.force, b.force));
    }
    EXPECT_GT(contacts, 10);
    EXPECT_GT(most, 0.3);
    EXPECT_LT(worst, 0.05 * most) << every;
  }
}

// The tracker's poses are of one time: the body's motion since then is motion of the tool against it.
TEST(TwoRates, OldSearchesOfAMovingBodyLoseLittle) {
  Options options;
  options.subdivision = 3;
  const Opened ball(ball_content(options));
  Contact alone(ball.view, 0), searched(ball.view, 0);
  Search latest, coming;
  double most = 0, worst = 0;
  int tick = 0;
  for (double t = 0; t < 8; t += kTick, ++tick) {
    const RigidMotion body{&ball.view, turned(0.2 * std::sin(2 * t), {0, 0, 1}, {0.01 * std::sin(3 * t), 0, 0})};
    const Pose tool = body.pose * dipping(t);
    if (tick % 40 == 0) {
      latest = tick > 0 ? coming : runtime::search(ball.view, 0, dipping(t));
      coming = runtime::search(ball.view, 0, runtime::in_body(tool, body.pose));
    }
    const Tick a = alone.tick(tool, body), b = searched.tick(tool, body, &latest);
    most = std::fmax(most, length(a.force));
    worst = std::fmax(worst, distance(a.force, b.force));
  }
  EXPECT_GT(most, 0.3);
  EXPECT_LT(worst, 0.05 * most);
}

// The walk from the old place may or may not come to where the tool is now.
TEST(TwoRates, BodyMetBehindAStoppedSearchBeginsWithoutAStep) {
  for (const int cells : {4, 32}) {
    Options options = uniform();
    options.cells = cells;
    const Opened box(box_content(options));
    Contact contact(box.view, 0);
    const double beside = kBoxSize / 2 + kTipRadius;
    const Search stopped = runtime::search(box.view, 0, upright({beside + 0.01, 0, 0}));
    for (double x = beside + 0.01; x > 0; x -= 1e-4) {
      EXPECT_EQ(length(contact.tick(upright({x, 0, kTop + kTipRadius + 0.02}), stopped).force), 0);
    }
    Pose pose = upright({0, 0, kTop + kTipRadius});
    Vec3 last;
    for (; pose.translation.z > kTop + kTipRadius - 0.002; pose.translation.z -= 1e-5) {
      const Vec3 force = contact.tick(pose, stopped).force;
      ASSERT_LT(distance(force, last), 0.02) << cells;
      last = force;
    }
    EXPECT_LT(distance(contact.tick(pose, runtime::search(box.view, 0, pose)).force, last), 0.02) << cells;
  }
}

/// The view of a body whose search tree is a trap: every search in it finds the same triangle.
struct Trap {
  runtime::View view;
  layout::SearchNode leaf{};
  explicit Trap(const runtime::View& good) : view(good) {
    leaf.set(0, 1);
    view.search = &leaf;
  }
  Trap(const Trap&) = delete;
  Trap& operator=(const Trap&) = delete;
};

/// Down between two lobes, to and fro, and out, at up to 0.05 m/s.
Pose between_lobes(double t) {
  const double depth = 0.002 * (1 - std::cos(8 * t)) - 0.001;
  return upright({0.0015 * std::sin(5 * t), 0.002 * std::sin(3 * t), between() - depth});
}

TEST(TwoRates, ContactWithSearchesNeverSearches) {
  Options options;
  options.subdivision = 3;
  options.search = true;
  const Opened ball(ball_content(options));
  const Trap trap(ball.view);
  ASSERT_NE(ball.view.search, nullptr);
  Contact searched(ball.view, 0), trapped(trap.view, 0);
  Search latest, coming;
  int touched = 0, tick = 0;
  for (double t = 0; t < 4; t += kTick, ++tick) {
    const Pose pose = dipping(t);
    if (tick % 5 == 0) {
      latest = tick > 0 ? coming : runtime::search(ball.view, 0, pose);
      coming = runtime::search(ball.view, 0, pose);
    }
    const Tick a = searched.tick(pose, latest), b = trapped.tick(pose, latest);
    ASSERT_EQ(a.state, b.state) << t;
    ASSERT_EQ(distance(a.force, b.force) + distance(a.body_point, b.body_point), 0) << t;
    touched += a.touches();
  }
  EXPECT_GT(touched, 500);
}

TEST(TwoRates, SetWithSearchesIsPushedByBothLobesAndNeverSearches) {
  for (const bool friction : {false, true}) {
    const Opened body(two_lobes(smooth(friction)));
    const Trap trap(body.view);
    for (const int every : {1, 5, 40}) {
      ContactSet<2> alone(body.view, 0), searched(body.view, 0), trapped(trap.view, 0);
      SetSearch<2> latest, coming;
      Vec3 last, seen_at;
      double most = 0, worst = 0, steepest = 0;
      int twice = 0, tick = 0;
      for (double t = 0; t < 4; t += kTick, ++tick) {
        const Pose pose = between_lobes(t);
        if (tick % every == 0) {
          latest = tick > 0 ? coming : runtime::search(body.view, 0, searched.request(pose));
          coming = runtime::search(body.view, 0, searched.request(pose));
        }
        const Tick a = alone.tick(pose), b = searched.tick(pose, latest), c = trapped.tick(pose, latest);
        ASSERT_EQ(distance(b.force, c.force) + distance(b.torque, c.torque), 0) << t;
        steepest = std::fmax(steepest, distance(b.force, last) / (1e-9 + distance(pose.translation, seen_at)));
        last = b.force;
        seen_at = pose.translation;
        most = std::fmax(most, length(a.force));
        worst = std::fmax(worst, distance(a.force, b.force));
        twice += searched.each()[0].touches() && searched.each()[1].touches();
      }
      EXPECT_GT(twice, 400);
      EXPECT_LT(steepest, 3 * 3000) << every << ' ' << friction;  // N/m, above any slope of two sample responses
      EXPECT_LT(worst, (every > 5 ? 0.25 : 0.1) * most) << every << ' ' << friction;
    }
  }
}

TEST(TwoRates, ThreadSearchesWhileAnotherMakesForces) {
  const Opened ball(ball_content({}));
  TripleBuffer<Pose> poses;
  TripleBuffer<Search> searches;
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
  int arrived = 0;
  for (double t = 0; t < 4; t += kTick) {
    const Pose pose = dipping(t);
    poses.write(pose);
    arrived += searches.read(latest);
    const Tick tick = contact.tick(pose, latest);
    ASSERT_TRUE(std::isfinite(length(tick.force)));
    ASSERT_LT(length(tick.force), 2 * kHertzForce);
    most = std::fmax(most, length(tick.force));
    std::this_thread::yield();
  }
  stop = true;
  searcher.join();
  EXPECT_GT(arrived, 10);
  EXPECT_GT(most, 0.1);
}

TEST(TwoRates, ThreadSearchesForWallsWhileAnotherMakesForces) {
  const Opened body(two_lobes(smooth(true)));
  TripleBuffer<WallSearchRequest<2>> requests;
  TripleBuffer<SetSearch<2>> searches;
  std::atomic<bool> stop{false};
  std::thread searcher([&] {
    WallSearchRequest<2> request;
    while (!stop.load(std::memory_order_relaxed)) {
      if (requests.read(request)) searches.write(runtime::search(body.view, 0, request));
      std::this_thread::yield();
    }
  });
  ContactSet<2> set(body.view, 0);
  SetSearch<2> latest = runtime::search(body.view, 0, set.request(between_lobes(0)));
  int twice = 0;
  for (double t = 0; t < 2; t += 0.5 * kTick) {
    const Tick tick = set.tick(between_lobes(t), latest);
    requests.write(set.request(between_lobes(t)));
    searches.read(latest);
    ASSERT_TRUE(std::isfinite(length(tick.force)));
    ASSERT_LT(length(tick.force), 4 * kHertzForce);
    twice += set.each()[0].touches() && set.each()[1].touches();
    std::this_thread::yield();
  }
  stop = true;
  searcher.join();
  EXPECT_GT(twice, 100);
}

TEST(TwoRates, ThreadSetsShapesWhileAnotherMakesForces) {
  const Opened ball(ball_content({}));
  std::vector<double> memory(DeformingSurface::bytes(ball.view) / sizeof(double) + 1);
  DeformingSurface surface(ball.view, memory.data());
  std::atomic<bool> stop{false};
  std::atomic<int> refused{0};
  std::thread host([&] {
    std::vector<Vec3> sites(ball.view.meta->site_count);
    for (int shape = 0; !stop.load(std::memory_order_relaxed); ++shape) {
      const double size = 1 + 0.05 * std::sin(0.2 * shape);
      for (std::uint32_t i = 0; i < sites.size(); ++i) sites[i] = size * runtime::vertex(ball.view, i);
      refused += !surface.set(sites.data(), ball.view.meta->site_count, 5 * kTick);
      std::this_thread::yield();
    }
  });
  Contact contact(ball.view, 0);
  double most = 0;
  for (double t = 0; t < 4; t += kTick) {
    surface.advance(kTick);
    const Tick tick = contact.tick(dipping(t), DeformingBody{&surface});
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

TEST(TwoRates, ThreadSetsFactorsWhileAnotherMakesForces) {
  const Opened box(box_content(uniform()));
  std::vector<SiteScales::Scale> memory(box.view.meta->site_count);
  SiteScales scales(box.view, memory.data());
  const StiffnessScale<StillBody> body{{&box.view}, &scales, &box.view, 5e-3};
  std::atomic<bool> done{false};
  std::thread writer([&] {
    std::mt19937 random(3);
    while (!done.load()) {
      scales.set(static_cast<std::uint32_t>(random() % box.view.meta->site_count),
                 static_cast<float>(random() % 200) / 100);
      std::this_thread::yield();
    }
  });
  Contact contact(box.view, 0);
  const auto pressed = [&](double depth) { return length(contact.tick(upright(centre(depth, 0.004, 0.002)), body).force); };
  pressed(-0.001);
  for (int k = 0; k <= 100; ++k) pressed(3e-5 * k);
  double last = pressed(0.003);
  bool good = true;
  for (int k = 0; good && k < 20000; ++k) {
    const double force = pressed(0.003);
    good = force >= 0 && std::fabs(force - last) <= 3 * 5e-3 * hertz(0.003);
    last = force;
  }
  done = true;
  writer.join();
  EXPECT_TRUE(good);
}

}  // namespace
}  // namespace palpate::two_rates_test
