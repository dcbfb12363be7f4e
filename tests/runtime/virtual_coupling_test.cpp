// SPDX-License-Identifier: GPL-3.0-or-later
// The virtual coupling against closed forms, its energy on any motion and any contact, and where it is nothing.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <type_traits>

#include "tests/runtime/allocation_counter.hpp"
#include "tests/runtime/coupling.hpp"
#include "tests/runtime/wandering.hpp"

namespace palpate::coupling_test {
namespace {

using runtime::Rigid;

/// A contact that is any function of position, and leaves what it last answered with outside.
struct Told {
  std::function<Vec3(const Vec3&)> law;
  Vec3* last = nullptr;
  int* ticks = nullptr;

  [[nodiscard]] double size() const { return 0.01; }
  void reset() {}
  Tick tick(const Pose& pose) {
    Tick tick;
    tick.state = State::stick;
    tick.force = law(pose.translation);
    if (last != nullptr) *last = tick.force;
    if (ticks != nullptr) ++*ticks;
    return tick;
  }
};
Vec3 wall(double stiffness, const Vec3& at) { return {0, 0, at.z < 0 ? -stiffness * at.z : 0}; }

TEST(VirtualCoupling, IsNothingWhereNoneIsNamed) {
  static_assert(std::is_empty_v<Rigid>);
  const Opened box(box_content({}));
  Contact held(box.view, 0), plain(box.view, 0);
  Wandering wandering(3);
  for (int i = 0; i < 5000; ++i) {
    const Pose pose = wandering.next();
    ASSERT_EQ(distance(Rigid().tick(held, pose, kTick).force, plain.tick(pose).force), 0);
  }
}

TEST(VirtualCoupling, IsExactlyNoForceInFreeSpace) {
  const Opened box(box_content({}));
  std::mt19937 random(5);
  for (const double damping : {0.0, 0.8}) {
    Contact contact(box.view, 0);
    VirtualCoupling tie(coupling(300, damping));
    Vec3 at{0, 0, kTop + kTipRadius + 0.02};
    for (int i = 0; i < 2000; ++i) {
      at = at + 1e-3 * random_direction(random);
      at.z = std::fmax(at.z, kTop + kTipRadius + 1e-3);
      const Tick tick = tie.tick(contact, upright(at), kTick);
      ASSERT_EQ(length(tick.force), 0);
      ASSERT_EQ(distance(tie.tool(), at), 0);
      ASSERT_EQ(tie.trials(), 1);
    }
    EXPECT_EQ(tie.lost(), 0);
  }
}

// f = -(1 / K + G^-1)^-1 (x - c), for a stiffness G that is no multiple of one and shears: on every tick of any motion,
// for without a damper the coupling has no past.
TEST(VirtualCoupling, IsInSeriesWithALinearContact) {
  const Vec3 rows[3] = {{700, 80, -60}, {80, 2500, 280}, {-60, 280, 9000}};
  const auto stiff = [&](const Vec3& s) { return Vec3{dot(rows[0], s), dot(rows[1], s), dot(rows[2], s)}; };
  std::mt19937 random(6);
  for (const double k : {50.0, 800.0, 2e4}) {
    Told contact{[&](const Vec3& x) { return -stiff(x); }};
    VirtualCoupling tie(coupling(k));
    Vec3 device, speed;
    tie.tick(contact, upright(device), kTick);
    int trials = 0;
    for (int i = 0; i < 3000; ++i) {
      speed = 0.98 * speed + 1e-5 * random_direction(random) - 1e-3 * device;
      device = device + speed;
      const Vec3 force = tie.tick(contact, upright(device), kTick).force;
      // (I + G / K) f = -G x.
      ASSERT_LT(distance(force + (1 / k) * stiff(force), -stiff(device)),
                2e-3 * length(force) * (1 + 9000 / k) + 1e-7 * (9000 + k))
          << k << ' ' << i;
      ASSERT_TRUE(tie.balanced()) << k << ' ' << i;
      trials += i > 100 ? tie.trials() : 0;
    }
    EXPECT_LT(trials, 2900 * 1.5) << k;
  }
}

// Pressed into a body: the depth z with hertz(z) + K z = K times the way.
TEST(VirtualCoupling, IsInSeriesWithABody) {
  Options options = uniform();
  options.friction = options.lateral = false;
  const Opened box(box_content(options));
  for (const double k : {40.0, 400.0, 4000.0, 4e6}) {
    Contact contact(box.view, 0);
    VirtualCoupling tie(coupling(k));
    for (int i = -50; i <= 600; ++i) {
      const double way = 1e-5 * (i < 300 ? i : 600 - i);
      const double force = tie.tick(contact, upright({1e-3, 2e-3, kTop + kTipRadius - way}), kTick).force.z;
      double low = 0, high = std::fmax(way, 0);
      for (int n = 0; n < 60; ++n) {
        const double z = 0.5 * (low + high);
        (hertz(z) + k * z < k * way ? low : high) = z;
      }
      // 0.1 % of the force, and 0.1 um of the spring.
      ASSERT_NEAR(force, hertz(low), 2e-3 * hertz(low) + 1e-7 * std::fmin(k, 5000)) << k << ' ' << i;
    }
  }
}

TEST(VirtualCoupling, OfAStiffSpringIsThePlainForce) {
  for (const int order : {0, 4}) {
    Options options;
    options.coupled = order;
    const Opened box(box_content(options));
    Contact contact(box.view, 0), plain(box.view, 0);
    VirtualCoupling tie(coupling(1e8));
    Wandering wandering(8);
    int touching = 0;
    for (int i = 0; i < 20000; ++i) {
      const Pose pose = wandering.next();
      const Vec3 force = plain.tick(pose).force;
      ASSERT_LT(distance(tie.tick(contact, pose, kTick).force, force), 2e-3 * length(force) + 2e-3) << i;
      touching += length(force) > 0;
    }
    EXPECT_GT(touching, 10000);
  }
}

// A first touch has lost nothing yet that could pay for what rounding leaves of a balance.
TEST(VirtualCoupling, TouchesSoftlyHoweverStiffItIs) {
  const Opened box(box_content({}));
  std::mt19937 random(13);
  for (const double stiffness : {1e6, 1e8, 1e10, 1e12}) {
    for (int i = 0; i < 300; ++i) {
      Contact contact(box.view, 0), plain(box.view, 0);
      VirtualCoupling tie(coupling(stiffness));
      Vec3 way = 5e-5 * random_direction(random);
      way.z = -std::fabs(way.z);
      Vec3 at = Vec3{0, 0, kTop + kTipRadius} - 0.5 * way;
      for (int k = 0; k < 3; ++k, at = at + way) {
        const Vec3 force = plain.tick(upright(at)).force, tied = tie.tick(contact, upright(at), kTick).force;
        ASSERT_LT(distance(tied, force), 2e-3 * length(force) + 1e-4) << stiffness << ' ' << i << ' ' << k;
      }
    }
  }
}

// Against a contact that does not give way the damper answers with the step of Euler, and lets the tool back freely.
TEST(VirtualCoupling, DampsByTheImplicitStep) {
  Told contact{[](const Vec3& x) { return wall(1e9, x); }};
  constexpr double kStiff = 500, kDamp = 1.5;
  VirtualCoupling tie(coupling(kStiff, kDamp));
  double last = 0;
  for (int i = 0; i < 200; ++i) {
    const double depth = 2e-3 * std::sin(0.02 * i), seconds = i % 3 == 0 ? 1e-3 : 4e-4;
    const double force = tie.tick(contact, upright({0, 0, -depth}), seconds).force.z;
    const double expected = kStiff * depth + kDamp * (depth - last) / seconds;
    ASSERT_NEAR(force, std::fmax(expected, 0), 2e-3 * std::fabs(expected) + 1e-4) << i;
    // Where it would pull the tool is free.
    if (!(expected > 0)) break;
    last = depth;
  }
  // Left at once, the tool comes back by the share that the step leaves, and nothing is felt of it.
  const double share = (kDamp / kTick) / (kStiff + kDamp / kTick);
  double away = length(tie.tool() - Vec3{0, 0, 0.02});
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(length(tie.tick(contact, upright({0, 0, 0.005}), kTick).force), 0);
    const double now = distance(tie.tool(), {0, 0, 0.005});
    if (i > 0) {
      ASSERT_NEAR(now, share * away, 1e-15);
    }
    away = now;
  }
}

/// What a coupling took in over both sides, forces at the end of a tick times motions within it.
struct Ledger {
  double in = 0, contact = 0;
  Vec3 device, tool;
  bool started = false;

  void add(const Vec3& at, const Vec3& tool_at, const Vec3& felt, const Vec3& force) {
    if (started) {
      contact += dot(force, tool_at - tool);
      in += dot(force, tool_at - tool) - dot(felt, at - device);
    }
    started = true;
    device = at;
    tool = tool_at;
  }
};

// On bodies with friction, turning tools and random times between ticks.
TEST(VirtualCoupling, GivesNoMoreThanItTookIn) {
  struct Spy {
    Contact contact;
    Vec3* last;
    [[nodiscard]] double size() const { return contact.size(); }
    void reset() { contact.reset(); }
    Tick tick(const Pose& pose) {
      const Tick tick = contact.tick(pose);
      *last = tick.force;
      return tick;
    }
  };
  Options options;
  options.tools = Options::Tools::all;
  for (const int order : {0, 4}) {
    options.coupled = order;
    const Opened box(box_content(options));
    for (const double k : {20.0, 150.0, 1500.0}) {
      for (const double b : {0.0, 0.4}) {
        for (std::uint32_t tool = 0; tool < 3; ++tool) {
          Vec3 force;
          Spy contact{Contact(box.view, tool), &force};
          VirtualCoupling tie(coupling(k, b));
          Ledger ledger;
          Wandering wandering(tool + 11);
          std::mt19937 random(tool);
          int unbalanced = 0, touching = 0;
          double least = HUGE_VAL;
          for (int i = 0; i < 3000; ++i) {
            const Pose pose = wandering.next();
            const Vec3 felt = tie.tick(contact, pose, 2e-4 + 1e-6 * static_cast<double>(random() % 1000)).force;
            ledger.add(pose.translation, tie.tool(), felt, force);
            // All that came in is stored or lost, and what is lost stays so.
            ASSERT_NEAR(ledger.in, tie.stored() + tie.lost(), 1e-12 + 1e-9 * tie.lost()) << i;
            ASSERT_GE(tie.lost(), 0);
            least = std::fmin(least, ledger.in);
            ASSERT_LE(tie.trials(), tie.options().trials + 1);
            touching += length(felt) > 0;
            unbalanced += !tie.balanced();
          }
          EXPECT_GE(least, -1e-12);
          EXPECT_GT(touching, 700);
          EXPECT_LT(unbalanced, 0.05 * touching) << k << ' ' << b << ' ' << tool;
        }
      }
    }
  }
}

// A motion without steps has a force without steps: it changes no faster than spring and damper do.
TEST(VirtualCoupling, KeepsTheForceContinuous) {
  for (const int order : {0, 4}) {
    Options options;
    options.coupled = order;
    const Opened box(box_content(options));
    for (const double k : {60.0, 600.0}) {
      Contact contact(box.view, 0);
      VirtualCoupling tie(coupling(k));
      Vec3 last_force, last;
      double most = 0;
      for (int i = 0; i < 12000; ++i) {
        // Down, aside until it slides, back and up, several times.
        const double t = 1e-3 * i;
        const Vec3 at{0.004 * std::sin(5 * t), 0.001 * std::cos(3 * t), kTop + kTipRadius - 0.003 * std::sin(2 * t)};
        const Vec3 force = tie.tick(contact, upright(at), kTick).force;
        if (i > 0) most = std::fmax(most, distance(force, last_force) - k * distance(at, last));
        last = at;
        last_force = force;
      }
      EXPECT_LT(most, 2e-3) << order << ' ' << k;
    }
  }
}

// Laws that no contact should have: the force is finite and that of the spring, and no energy comes out of the
// coupling.
void expect_bounded(const char* name, const std::function<Vec3(const Vec3&)>& law, double damping) {
  Vec3 force;
  int ticks = 0;
  Told contact{law, &force, &ticks};
  VirtualCoupling tie(coupling(400, damping));
  Ledger ledger;
  Vec3 lag;
  for (int i = 0; i < 4000; ++i) {
    const double t = 5e-3 * i;
    const Vec3 at{1e-3 * std::sin(t), 2e-3 * std::sin(0.7 * t), 3e-3 * std::sin(0.3 * t)};
    const int before = ticks;
    const Vec3 felt = tie.tick(contact, upright(at), kTick).force;
    ledger.add(at, tie.tool(), felt, force);
    if (i == 0) ledger.in = tie.stored();
    const Vec3 now = tie.tool() - at;
    ASSERT_LT(distance(felt, 400 * now + (damping / kTick) * (now - lag)), 1e-9 * (1 + length(felt))) << name << i;
    ASSERT_TRUE(std::isfinite(length(felt))) << name << i;
    ASSERT_LE(ticks - before, tie.options().trials + 1) << name;
    ASSERT_GE(tie.lost(), 0) << name << i;
    ASSERT_GE(ledger.in, -1e-12 * (1 + std::fabs(ledger.contact))) << name << i;
    lag = now;
  }
}

TEST(VirtualCoupling, BoundsWhatNoBalanceIsFoundFor) {
  for (const double damping : {0.0, 0.5}) {
    expect_bounded(
        "a step",
        [](const Vec3& x) {
          return Vec3{0, 0, x.z < 0 ? 1.0 : 0.0};
        },
        damping);
    expect_bounded(
        "a step that pulls",
        [](const Vec3& x) {
          return Vec3{0, 0, x.z < 0 ? -1.0 : 1.0};
        },
        damping);
    expect_bounded(
        "it falls", [](const Vec3& x) { return 1000 * x; }, damping);
    expect_bounded(
        "a whirl",
        [](const Vec3& x) {
          return Vec3{-2000 * x.y, 2000 * x.x, -300 * x.z};
        },
        damping);
    expect_bounded(
        "very stiff", [](const Vec3& x) { return wall(1e12, x); }, damping);
    expect_bounded(
        "noise",
        [](const Vec3& x) {
          std::uint64_t bits = 0;
          std::memcpy(&bits, &x.z, sizeof bits);
          bits *= 0x9e3779b97f4a7c15u;
          return Vec3{1e-3 * static_cast<double>(bits >> 54), 0, 1e-3 * static_cast<double>((bits >> 40) % 1024)};
        },
        damping);
  }
}

// A contact that gives out energy on every way round: the tool is held back, the hand gets nothing of it, and with a
// way that costs energy it goes on.
TEST(VirtualCoupling, KeepsFromTheHandWhatTheContactMakes) {
  constexpr double kOften = 0.01;
  for (const double turning : {1.0, -1.0}) {
    Told contact{[](const Vec3& x) { return Vec3{-2000 * x.y, 2000 * x.x, 0}; }};
    VirtualCoupling tie(coupling(400));
    double hand = 0, least = 0;
    Vec3 last, felt;
    for (int i = 0; i < 4000; ++i) {
      const double far = 1e-3 * std::fmin(1, i / 500.0);
      const Vec3 at{far * std::cos(kOften * i), turning * far * std::sin(kOften * i), 0};
      const Vec3 force = tie.tick(contact, upright(at), kTick).force;
      if (i > 0) hand += 0.5 * dot(felt + force, at - last);
      least = std::fmin(least, hand);
      ASSERT_LE(hand, 1e-9 - 0.01 * least) << turning << ' ' << i;
      last = at;
      felt = force;
    }
    if (turning < 0) {
      // A turn with a whirl g behind a spring K costs 2 pi r^2 g K^2 / (K^2 + g^2); here there are more than six.
      EXPECT_LT(hand, -5 * 6.28 * 1e-6 * 2000 * 400 * 400 / (400.0 * 400 + 2000.0 * 2000));
    }
  }
}

TEST(VirtualCoupling, BeginsAnewWhereTheDeviceLeaps) {
  const Opened box(box_content({}));
  Contact contact(box.view, 0);
  VirtualCoupling tie(coupling(200));
  const Vec3 top{0, 0, kTop + kTipRadius};
  const auto press = [&] {
    Tick tick;
    for (int i = 0; i < 300; ++i) tick = tie.tick(contact, upright(top + Vec3{0, 0, 1e-3 - 1e-5 * i}), kTick);
    return length(tick.force);
  };
  const double pressed = press();
  EXPECT_GT(pressed, 0.1);
  // Put elsewhere and into the body: what it finds there is no work of the hand.
  EXPECT_EQ(length(tie.tick(contact, upright(top + Vec3{0.012, 0, -0.003}), kTick).force), 0);
  EXPECT_EQ(length(tie.tick(contact, upright(top + Vec3{0, 0, 0.02}), kTick).force), 0);
  EXPECT_NEAR(press(), pressed, 1e-9);
  // No pose, no time: a fault, and all is forgotten.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [pose, seconds] : {std::pair{upright({nan, 0, 0}), kTick},
                                      {upright({nan, 0, 0}), 0.0},
                                      {upright(top), -kTick},
                                      {upright(top), nan}}) {
    press();
    const Tick tick = tie.tick(contact, pose, seconds);
    EXPECT_EQ(tick.state, State::fault);
    EXPECT_EQ(length(tick.force), 0);
    EXPECT_EQ(length(tie.tick(contact, upright(top + Vec3{0, 0, -0.002}), kTick).force), 0);
    tie.tick(contact, upright(top + Vec3{0, 0, 0.02}), kTick);
  }
  EXPECT_NEAR(press(), pressed, 1e-9);
}

TEST(VirtualCoupling, AllocatesNothingAndGivesTheSameBits) {
  Options options;
  options.coupled = 4;
  const Opened box(box_content(options));
  const auto run = [&] {
    checksum::Xxh64 hash;
    Contact contact(box.view, 0);
    VirtualCoupling tie(coupling(250, 0.1));
    Wandering wandering(9);
    for (int i = 0; i < 10000; ++i) {
      const Tick tick = tie.tick(contact, wandering.next(), kTick);
      hash.update(&tick.force, sizeof tick.force);
      hash.update(&tick.torque, sizeof tick.torque);
    }
    return hash.digest();
  };
  const long before = allocations();
  const auto first = run();
  EXPECT_EQ(allocations(), before);
  EXPECT_EQ(run(), first);
}

TEST(VirtualCoupling, KnowsUsableOptions) {
  EXPECT_EQ(CouplingOptions().validate(), nullptr);
  for (const auto change :
       {+[](CouplingOptions& o) { o.stiffness = 0; }, +[](CouplingOptions& o) { o.stiffness = NAN; },
        +[](CouplingOptions& o) { o.damping = -1; }, +[](CouplingOptions& o) { o.damping = HUGE_VAL; },
        +[](CouplingOptions& o) { o.trials = 1; }, +[](CouplingOptions& o) { o.trials = 65; }}) {
    CouplingOptions options;
    change(options);
    ASSERT_NE(options.validate(), nullptr);
    VirtualCoupling tie(options);
    EXPECT_STREQ(tie.validate(), options.validate());
    Told contact{[](const Vec3& x) { return wall(1000, x); }};
    for (const double seconds : {kTick, 0.0, kTick}) {
      const Tick tick = tie.tick(contact, upright({0, 0, -1e-3}), seconds);
      EXPECT_EQ(tick.state, State::fault);
      EXPECT_EQ(length(tick.force), 0);
    }
  }
}

}  // namespace
}  // namespace palpate::coupling_test
