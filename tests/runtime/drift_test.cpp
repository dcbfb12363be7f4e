// SPDX-License-Identifier: GPL-3.0-or-later
// Vibration under a bias below the friction limit moves nothing (Hayward and Armstrong, "A new computational model of
// friction applied to haptic rendering", 2000): Dahl's model creeps there, and does so on the very same motion.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;

constexpr int kCycle = 8;  // ticks

/// Dahl's x' = v (1 - sgn(v) f / fc) with f = k x, exact for every straight step.
struct Dahl {
  double stiffness, limit, force;
  void move(double way) {
    const double most = std::copysign(limit, way);
    force = most + (force - most) * std::exp(-stiffness * std::abs(way) / limit);
  }
};

/// A tip in a flat top, where sideways motion changes no depth, drawn until the sideways force is half of what friction
/// holds.
struct Drawn {
  int coupled;  ///< order; 0: separable
  bool rim;
  double direction;                         ///< of x
  static constexpr double kPressed = 2e-3;  // m

  Opened box{content()};
  Contact contact{box.view, 0};
  double middle = 0;  ///< m, along the direction

  Drawn(int order, bool with_rim, double way) : coupled(order), rim(with_rim), direction(way) {
    for (double z = -1e-4; z < kPressed; z += 2e-5) contact.tick(tip(0, z));
    middle = reaches(contact, 0, 0.5);
  }
  [[nodiscard]] ResponseFileContent content() const {
    Options options;
    options.coupled = coupled;
    options.rim = rim;
    return box_content(options);
  }
  static Pose tip(double x, double z) { return upright({0.003 + x, 0.002, kTop + kTipRadius - z}); }
  [[nodiscard]] Pose at(double x) const { return tip(direction * x, kPressed); }
  /// N, of the hand, along the direction.
  [[nodiscard]] double along(const Tick& tick) const { return -direction * tick.force.x; }
  /// N of that, which friction bears: all but the straight push's.
  [[nodiscard]] double friction(const Contact& drawn, const Tick& tick) const {
    return along(tick) + direction * drawn.field().at_depth(tick.depth).straight.x;
  }
  /// m, where friction comes to such a share of the limit, drawn on from x.
  double reaches(Contact& drawn, double x, double share) const {
    for (;; x += 1e-7) {
      const Tick tick = drawn.tick(at(x));
      if (friction(drawn, tick) >= share * tick.friction_limit || tick.state != State::stick) return x;
    }
  }
};

/// In every kind of file, and both ways.
template <class Work>
void of_all(const Work& work) {
  const auto of = [&](const char* name, int coupled, bool rim, double direction) {
    SCOPED_TRACE(name);
    Drawn drawn(coupled, rim, direction);
    work(drawn);
  };
  of("separable", 0, false, 1);
  of("separable, back", 0, false, -1);
  of("separable with a rim", 0, true, 1);
  of("coupled", 4, false, 1);
  of("coupled with a rim", 2, true, 1);
  of("coupled with a rim, back", 4, true, -1);
}

/// The same in every cycle.
double wave(int k) { return std::sin(2 * std::numbers::pi * (k % kCycle) / kCycle); }

struct Vibration {
  double share;         ///< of the limit
  int cycles, settled;  ///< in all, and after which nothing changes any more
};

void vibrate(const Drawn& drawn, const Vibration& vibration) {
  Contact contact = drawn.contact, further = drawn.contact;
  const Tick start = contact.tick(drawn.at(drawn.middle));
  const double amplitude = drawn.reaches(further, drawn.middle, 0.5 + vibration.share) - drawn.middle;
  Dahl dahl{vibration.share * start.friction_limit / amplitude, start.friction_limit, drawn.friction(contact, start)};
  Vec3 early, settled, mean;  // N, of a cycle
  double least = 1, most = 0, from = 0, of_dahl = 0;
  for (int cycle = 0; cycle < vibration.cycles; ++cycle) {
    mean = {};
    of_dahl = 0;
    for (int k = 0; k < kCycle; ++k) {
      const double x = amplitude * wave(k);
      const Tick tick = contact.tick(drawn.at(drawn.middle + x));
      ASSERT_EQ(tick.state, State::stick) << cycle;
      ASSERT_EQ(distance(tick.body_point, start.body_point), 0) << cycle;
      mean = mean + (1.0 / kCycle) * tick.force;
      least = std::min(least, drawn.friction(contact, tick) / start.friction_limit);
      most = std::max(most, drawn.friction(contact, tick) / start.friction_limit);
      dahl.move(x - from);
      of_dahl += dahl.force / kCycle;
      from = x;
    }
    if (cycle == 1) early = mean;
    if (cycle == vibration.settled) settled = mean;
  }
  EXPECT_NEAR(most, 0.5 + vibration.share, 1e-3);
  EXPECT_LT(least, 0.5 - 0.9 * vibration.share);
  EXPECT_LE(distance(mean, settled), 1e-9 * length(mean));
  EXPECT_LE(distance(mean, early), 5e-3 * length(mean));
  EXPECT_LT(of_dahl, 1e-3 * start.friction_limit);
}

TEST(Drift, VibrationBelowTheLimitMovesNothing) {
  of_all([](const Drawn& drawn) {
    vibrate(drawn, {0.1, 100000, 1});
    // The rim slips to and fro, each time along its force: at first it loses what it bears across.
    vibrate(drawn, {0.4, 10000, 1000});
  });
}

// What a trembling hand lets go and takes up again bears nothing the second time: the force is lost once, not by every
// cycle. (By every cycle it would be gone within seconds.)
TEST(Drift, AHandThatTremblesUpAndDownKeepsItsSidewaysForce) {
  of_all([](const Drawn& drawn) {
    const auto at = [&](double lift) { return drawn.tip(drawn.direction * drawn.middle, Drawn::kPressed - lift); };
    std::mt19937 random(4);
    const auto noise = [&](int) { return 5e-6 * (static_cast<double>(random() % 3) - 1); };
    const auto tremor = [](int k) { return 5e-5 * std::sin(2 * std::numbers::pi * k / 100); };
    const auto breath = [](int k) { return 2e-4 * std::sin(2 * std::numbers::pi * k / 4000); };
    const std::pair<std::function<double(int)>, double> hands[] = {{noise, 0.98}, {tremor, 0.9}, {breath, 0.75}};
    for (const auto& [hand, kept] : hands) {
      Contact contact = drawn.contact;
      const double before = drawn.along(contact.tick(at(0)));
      double early = 0;
      for (int k = 1; k <= 60000; ++k) {
        ASSERT_EQ(contact.tick(at(hand(k))).state, State::stick) << k;
        if (k == 8000) early = drawn.along(Contact(contact).tick(at(0)));
      }
      const double late = drawn.along(contact.tick(at(0)));
      EXPECT_GT(late, kept * before);
      EXPECT_GT(late, 0.95 * early);
    }
  });
}

// Every cycle takes the tool a little further than the last: at its peak the contact slides by that.
TEST(Drift, WhereItReachesTheLimitTheContactCreepsThatWayOnly) {
  constexpr int kCycles = 10000;
  constexpr double kOnward = 1e-7;  // m a cycle
  of_all([](Drawn& drawn) {
    // From a contact that slid so far that its c has taken over how far pressing moved its anchor.
    for (int k = 0; k < 1000; ++k) drawn.contact.tick(drawn.at(drawn.middle += 1e-6));
    drawn.middle -= 2e-4;
    const double amplitude = drawn.reaches(drawn.contact, drawn.middle, 1) - drawn.middle;
    const Vec3 start = drawn.contact.tick(drawn.at(drawn.middle + amplitude)).body_point;
    Vec3 c = start;
    int slid = 0;
    for (int k = 0; k < kCycles * kCycle; ++k) {
      const Tick tick = drawn.contact.tick(drawn.at(drawn.middle + kOnward * k / kCycle + amplitude * wave(k)));
      ASSERT_TRUE(tick.state == State::stick || tick.state == State::slide) << k;
      const double way = drawn.direction * (tick.body_point.x - c.x);
      ASSERT_GE(way, 0) << k;
      slid += way > 0;
      c = tick.body_point;
    }
    EXPECT_GT(slid, 0.99 * kCycles);
    // The limit is that of the place.
    EXPECT_NEAR(std::abs(c.x - start.x), kOnward * kCycles, 0.1 * kOnward * kCycles);
  });
}

}  // namespace
}  // namespace palpate
