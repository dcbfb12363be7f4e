// SPDX-License-Identifier: GPL-3.0-or-later
// Virtual coupling: closed forms, energy on any motion and any contact, free space, faults, moving bodies.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <type_traits>
#include <vector>

#include "palpate/body/rigid_motion.hpp"
#include "palpate/body/stiffness_scale.hpp"
#include "palpate/contact/contact_set.hpp"
#include "palpate/format/checksum.hpp"
#include "palpate/output/virtual_coupling.hpp"
#include "tests/runtime/allocation_counter.hpp"
#include "tests/runtime/support.hpp"
#include "tests/runtime/wandering.hpp"

namespace palpate::coupling_test {
namespace {

using namespace test;
using runtime::Contact;
using runtime::CouplingOptions;
using runtime::Fault;
using runtime::Rigid;
using runtime::RigidMotion;
using runtime::VirtualCoupling;

constexpr double kTick = 1e-3;

CouplingOptions coupling(double stiffness, double damping = 0) {
  CouplingOptions options;
  options.stiffness = stiffness;
  options.damping = damping;
  return options;
}

/// Energies of the hand's motions from free space to free space.
struct Loops {
  double taken = 0;  ///< J, from the hand, in all
  double given = 0;  ///< J, to the hand, most in one
  double work = 0;
  int touches = 0;
  Vec3 at, felt;

  void add(const Vec3& at_now, const Vec3& force) {
    work += 0.5 * dot(felt + force, at_now - at);
    if (!(length(force) > 0) && length(felt) > 0) {
      ++touches;
      taken += std::fmax(-work, 0);
      given = std::fmax(given, work);
      work = 0;
    }
    at = at_now;
    felt = force;
  }
};

/// A contact whose force is a function of position. `last` and `ticks`: the last force and the number of ticks.
struct Law {
  std::function<Vec3(const Vec3&)> law;
  Vec3* last = nullptr;
  int* ticks = nullptr;

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
double contact_size(const Law& /*contact*/) { return 0.01; }
Vec3 wall(double stiffness, const Vec3& at) { return {0, 0, at.z < 0 ? -stiffness * at.z : 0}; }

TEST(VirtualCoupling, RigidGivesTheForceOfTheContact) {
  static_assert(std::is_empty_v<Rigid>);
  const Opened box(box_content({}));
  Contact contact(box.view, 0), plain(box.view, 0);
  Wandering wandering(3);
  for (int i = 0; i < 5000; ++i) {
    const Pose pose = wandering.next();
    ASSERT_EQ(distance(Rigid().tick(contact, pose, kTick).force, plain.tick(pose).force), 0);
  }
}

TEST(VirtualCoupling, FreeSpaceHasExactlyNoForce) {
  const Opened box(box_content({}));
  std::mt19937 random(5);
  for (const double damping : {0.0, 0.8}) {
    Contact contact(box.view, 0);
    VirtualCoupling held(coupling(300, damping));
    Vec3 at{0, 0, kTop + kTipRadius + 0.02};
    for (int i = 0; i < 2000; ++i) {
      at = at + 1e-3 * random_direction(random);
      at.z = std::fmax(at.z, kTop + kTipRadius + 1e-3);
      const Tick tick = held.tick(contact, upright(at), kTick);
      ASSERT_EQ(length(tick.force), 0);
      ASSERT_EQ(distance(held.tool(), at), 0);
      ASSERT_EQ(held.trials(), 1);
    }
    EXPECT_EQ(held.lost(), 0);
  }
}

// f = -(1 / K + G^-1)^-1 (x - c) in every tick, with an anisotropic stiffness G. Without damper there is no history.
TEST(VirtualCoupling, LinearContactIsInSeriesWithTheSpring) {
  const Vec3 rows[3] = {{700, 80, -60}, {80, 2500, 280}, {-60, 280, 9000}};
  const auto stiff = [&](const Vec3& s) { return Vec3{dot(rows[0], s), dot(rows[1], s), dot(rows[2], s)}; };
  std::mt19937 random(6);
  for (const double k : {50.0, 800.0, 2e4}) {
    Law contact{[&](const Vec3& x) { return -stiff(x); }};
    VirtualCoupling held(coupling(k));
    Vec3 device, speed;
    held.tick(contact, upright(device), kTick);
    int trials = 0;
    for (int i = 0; i < 3000; ++i) {
      speed = 0.98 * speed + 1e-5 * random_direction(random) - 1e-3 * device;
      device = device + speed;
      const Vec3 force = held.tick(contact, upright(device), kTick).force;
      // (I + G / K) f = -G x.
      ASSERT_LT(distance(force + (1 / k) * stiff(force), -stiff(device)),
                2e-3 * length(force) * (1 + 9000 / k) + 1e-7 * (9000 + k))
          << k << ' ' << i;
      ASSERT_TRUE(held.balanced()) << k << ' ' << i;
      trials += i > 100 ? held.trials() : 0;
    }
    EXPECT_LT(trials, 2900 * 1.5) << k;
  }
}

// The depth z solves hertz(z) + K z = K times the way.
TEST(VirtualCoupling, PressedBodyIsInSeriesWithTheSpring) {
  Options options = uniform();
  options.friction = options.bias = false;
  const Opened box(box_content(options));
  for (const double k : {40.0, 400.0, 4000.0, 4e6}) {
    Contact contact(box.view, 0);
    VirtualCoupling held(coupling(k));
    for (int i = -50; i <= 600; ++i) {
      const double way = 1e-5 * (i < 300 ? i : 600 - i);
      const double force = held.tick(contact, upright({1e-3, 2e-3, kTop + kTipRadius - way}), kTick).force.z;
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

TEST(VirtualCoupling, StiffSpringGivesTheForceOfTheContact) {
  const Opened box(box_content({}));
  Contact contact(box.view, 0), plain(box.view, 0);
  VirtualCoupling held(coupling(1e8));
  Wandering wandering(8);
  int touching = 0;
  for (int i = 0; i < 20000; ++i) {
    const Pose pose = wandering.next();
    const Vec3 force = plain.tick(pose).force;
    ASSERT_LT(distance(held.tick(contact, pose, kTick).force, force), 2e-3 * length(force) + 2e-3) << i;
    touching += length(force) > 0;
  }
  EXPECT_GT(touching, 10000);
}

// Nothing is dissipated before a first touch, so that rounding of the balance could break the energy inequality.
TEST(VirtualCoupling, FirstTouchOfAnyStiffnessHasTheForceOfTheContact) {
  const Opened box(box_content({}));
  std::mt19937 random(13);
  for (const double stiffness : {1e6, 1e8, 1e10, 1e12}) {
    for (int i = 0; i < 300; ++i) {
      Contact contact(box.view, 0), plain(box.view, 0);
      VirtualCoupling held(coupling(stiffness));
      Vec3 way = 5e-5 * random_direction(random);
      way.z = -std::fabs(way.z);
      Vec3 at = Vec3{0, 0, kTop + kTipRadius} - 0.5 * way;
      for (int k = 0; k < 3; ++k, at = at + way) {
        const Vec3 force = plain.tick(upright(at)).force, coupled = held.tick(contact, upright(at), kTick).force;
        ASSERT_LT(distance(coupled, force), 2e-3 * length(force) + 1e-4) << stiffness << ' ' << i << ' ' << k;
      }
    }
  }
}

// A rigid wall: the force is K s + B ds/T by the implicit step of Euler.
TEST(VirtualCoupling, DamperTakesTheImplicitStep) {
  Law contact{[](const Vec3& x) { return wall(1e9, x); }};
  constexpr double kStiff = 500, kDamp = 1.5;
  VirtualCoupling held(coupling(kStiff, kDamp));
  double last = 0;
  for (int i = 0; i < 200; ++i) {
    const double depth = 2e-3 * std::sin(0.02 * i), seconds = i % 3 == 0 ? 1e-3 : 4e-4;
    const double force = held.tick(contact, upright({0, 0, -depth}), seconds).force.z;
    const double expected = kStiff * depth + kDamp * (depth - last) / seconds;
    ASSERT_NEAR(force, std::fmax(expected, 0), 2e-3 * std::fabs(expected) + 1e-4) << i;
    // The tool is free before the coupling would pull it.
    if (!(expected > 0)) break;
    last = depth;
  }
  // A tool that left at once returns to the device without force.
  const double share = (kDamp / kTick) / (kStiff + kDamp / kTick);
  double away = length(held.tool() - Vec3{0, 0, 0.02});
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(length(held.tick(contact, upright({0, 0, 0.005}), kTick).force), 0);
    const double now = distance(held.tool(), {0, 0, 0.005});
    if (i > 0) {
      ASSERT_NEAR(now, share * away, 1e-15);
    }
    away = now;
  }
}

/// Energy into a coupling from both sides: forces at the end of a tick times motions within it.
struct EnergySum {
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

// Bodies with friction, rotating tools, random times between ticks.
TEST(VirtualCoupling, EnergyInEqualsStoredPlusDissipated) {
  struct Spy {
    Contact contact;
    Vec3* last;
    [[nodiscard]] double size(double depth) const { return contact.size(depth); }
    [[nodiscard]] const runtime::View& view() const { return contact.view(); }
    void reset() { contact.reset(); }
    Tick tick(const Pose& pose) {
      const Tick tick = contact.tick(pose);
      *last = tick.force;
      return tick;
    }
  };
  Options options;
  options.tools = Options::Tools::all;
  const Opened box(box_content(options));
  for (const double k : {20.0, 150.0, 1500.0}) {
    for (const double b : {0.0, 0.4}) {
      for (std::uint32_t tool = 0; tool < 3; ++tool) {
        Vec3 force;
        Spy contact{Contact(box.view, tool), &force};
        VirtualCoupling held(coupling(k, b));
        EnergySum sum;
        Wandering wandering(tool + 11);
        std::mt19937 random(tool);
        int unbalanced = 0, touching = 0;
        double least = HUGE_VAL;
        for (int i = 0; i < 3000; ++i) {
          const Pose pose = wandering.next();
          const Vec3 felt = held.tick(contact, pose, 2e-4 + 1e-6 * static_cast<double>(random() % 1000)).force;
          sum.add(pose.translation, held.tool(), felt, force);
          // The sum is stored or dissipated, and dissipated energy is never negative.
          ASSERT_NEAR(sum.in, held.stored() + held.lost(), 1e-12 + 1e-9 * held.lost()) << i;
          ASSERT_GE(held.lost(), 0);
          least = std::fmin(least, sum.in);
          ASSERT_LE(held.trials(), held.options().trials + 1);
          touching += length(felt) > 0;
          unbalanced += !held.balanced();
        }
        EXPECT_GE(least, -1e-12);
        EXPECT_GT(touching, 700);
        EXPECT_LT(unbalanced, 0.05 * touching) << k << ' ' << b << ' ' << tool;
      }
    }
  }
}

// The force changes no faster than the spring allows.
TEST(VirtualCoupling, SmoothMotionHasAContinuousForce) {
  const Opened box(box_content({}));
  for (const double k : {60.0, 600.0}) {
    Contact contact(box.view, 0);
    VirtualCoupling held(coupling(k));
    Vec3 last_force, last;
    double most = 0;
    for (int i = 0; i < 12000; ++i) {
      // Down, aside until it slides, back and up, several times.
      const double t = 1e-3 * i;
      const Vec3 at{0.004 * std::sin(5 * t), 0.001 * std::cos(3 * t), kTop + kTipRadius - 0.003 * std::sin(2 * t)};
      const Vec3 force = held.tick(contact, upright(at), kTick).force;
      if (i > 0) most = std::fmax(most, distance(force, last_force) - k * distance(at, last));
      last = at;
      last_force = force;
    }
    EXPECT_LT(most, 2e-3) << k;
  }
}

// Laws that no contact has: the force is finite and that of the spring, and the coupling gives out no energy.
void expect_bounded(const char* name, const std::function<Vec3(const Vec3&)>& law, double damping) {
  Vec3 force;
  int ticks = 0;
  Law contact{law, &force, &ticks};
  VirtualCoupling held(coupling(400, damping));
  EnergySum sum;
  Vec3 lag;
  for (int i = 0; i < 4000; ++i) {
    const double t = 5e-3 * i;
    const Vec3 at{1e-3 * std::sin(t), 2e-3 * std::sin(0.7 * t), 3e-3 * std::sin(0.3 * t)};
    const int before = ticks;
    const Vec3 felt = held.tick(contact, upright(at), kTick).force;
    sum.add(at, held.tool(), felt, force);
    if (i == 0) sum.in = held.stored();
    const Vec3 now = held.tool() - at;
    ASSERT_LT(distance(felt, 400 * now + (damping / kTick) * (now - lag)), 1e-9 * (1 + length(felt))) << name << i;
    ASSERT_TRUE(std::isfinite(length(felt))) << name << i;
    ASSERT_LE(ticks - before, held.options().trials + 1) << name;
    ASSERT_GE(held.lost(), 0) << name << i;
    ASSERT_GE(sum.in, -1e-12 * (1 + std::fabs(sum.contact))) << name << i;
    lag = now;
  }
}

TEST(VirtualCoupling, ContactWithoutBalanceGivesBoundedEnergy) {
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

// A contact that gives out energy on every circle: the tool is held back and the hand gets none of the energy.
TEST(VirtualCoupling, ActiveContactGivesTheHandNoEnergy) {
  constexpr double kOften = 0.01;
  for (const double turning : {1.0, -1.0}) {
    Law contact{[](const Vec3& x) { return Vec3{-2000 * x.y, 2000 * x.x, 0}; }};
    VirtualCoupling held(coupling(400));
    double hand = 0, least = 0;
    Vec3 last, felt;
    for (int i = 0; i < 4000; ++i) {
      const double far = 1e-3 * std::fmin(1, i / 500.0);
      const Vec3 at{far * std::cos(kOften * i), turning * far * std::sin(kOften * i), 0};
      const Vec3 force = held.tick(contact, upright(at), kTick).force;
      if (i > 0) hand += 0.5 * dot(felt + force, at - last);
      least = std::fmin(least, hand);
      ASSERT_LE(hand, 1e-9 - 0.01 * least) << turning << ' ' << i;
      last = at;
      felt = force;
    }
    if (turning < 0) {
      // A circle with a whirl g behind a spring K costs 2 pi r^2 g K^2 / (K^2 + g^2); here there are more than six.
      EXPECT_LT(hand, -5 * 6.28 * 1e-6 * 2000 * 400 * 400 / (400.0 * 400 + 2000.0 * 2000));
    }
  }
}

TEST(VirtualCoupling, JumpOfTheDeviceBeginsWithoutForce) {
  const Opened box(box_content({}));
  Contact contact(box.view, 0);
  VirtualCoupling held(coupling(200));
  const Vec3 top{0, 0, kTop + kTipRadius};
  const auto press = [&] {
    Tick tick;
    for (int i = 0; i < 300; ++i) tick = held.tick(contact, upright(top + Vec3{0, 0, 1e-3 - 1e-5 * i}), kTick);
    return length(tick.force);
  };
  const double pressed = press();
  EXPECT_GT(pressed, 0.1);
  // A tool that was put into the body begins without force.
  EXPECT_EQ(length(held.tick(contact, upright(top + Vec3{0.012, 0, -0.003}), kTick).force), 0);
  EXPECT_EQ(length(held.tick(contact, upright(top + Vec3{0, 0, 0.02}), kTick).force), 0);
  EXPECT_NEAR(press(), pressed, 1e-9);
  // An invalid pose or time is a fault that resets the coupling.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [pose, seconds] : {std::pair{upright({nan, 0, 0}), kTick},
                                      {upright({nan, 0, 0}), 0.0},
                                      {upright(top), -kTick},
                                      {upright(top), nan}}) {
    press();
    const Tick tick = held.tick(contact, pose, seconds);
    EXPECT_EQ(tick.state, State::fault);
    EXPECT_EQ(length(tick.force), 0);
    EXPECT_EQ(length(held.tick(contact, upright(top + Vec3{0, 0, -0.002}), kTick).force), 0);
    held.tick(contact, upright(top + Vec3{0, 0, 0.02}), kTick);
  }
  EXPECT_NEAR(press(), pressed, 1e-9);
}

TEST(VirtualCoupling, TicksAllocateNothingAndRepeatBitByBit) {
  const Opened box(box_content({}));
  const auto run = [&] {
    checksum::Xxh64 hash;
    Contact contact(box.view, 0);
    VirtualCoupling held(coupling(250, 0.1));
    Wandering wandering(9);
    for (int i = 0; i < 10000; ++i) {
      const Tick tick = held.tick(contact, wandering.next(), kTick);
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

TEST(VirtualCoupling, OptionOutOfRangeIsAFault) {
  EXPECT_EQ(CouplingOptions().validate(), nullptr);
  for (const auto change :
       {+[](CouplingOptions& o) { o.stiffness = 0; }, +[](CouplingOptions& o) { o.stiffness = NAN; },
        +[](CouplingOptions& o) { o.damping = -1; }, +[](CouplingOptions& o) { o.damping = HUGE_VAL; },
        +[](CouplingOptions& o) { o.trials = 1; }, +[](CouplingOptions& o) { o.trials = 65; }}) {
    CouplingOptions options;
    change(options);
    ASSERT_NE(options.validate(), nullptr);
    VirtualCoupling held(options);
    EXPECT_STREQ(held.validate(), options.validate());
    Law contact{[](const Vec3& x) { return wall(1000, x); }};
    for (const double seconds : {kTick, 0.0, kTick}) {
      const Tick tick = held.tick(contact, upright({0, 0, -1e-3}), seconds);
      EXPECT_EQ(tick.state, State::fault);
      EXPECT_EQ(length(tick.force), 0);
    }
  }
}

TEST(VirtualCoupling, RigidlyMovingBodyGivesTheForceOfABodyAtRest) {
  const Opened box(box_content({}));
  Contact contact(box.view, 0), rest(box.view, 0);
  VirtualCoupling held(coupling(200, 0.1)), held_at_rest(coupling(200, 0.1));
  double most = 0;
  for (int i = 0; i < 3000; ++i) {
    const double t = kTick * i;
    const Pose pose = turned(0.4 * std::sin(3 * t), unit(Vec3{1, 2, -1}, {}), {0.02 * std::sin(7 * t), 0.5, 0.01 * t});
    const RigidMotion body{&box.view, pose};
    const Tick there = held.tick(contact, pose * probing(t), kTick, body);
    const Tick expected = runtime::transformed(pose, held_at_rest.tick(rest, probing(t), kTick));
    // Both balances are within 0.1 % of the force and 1e-5 of the contact's size.
    const double force = length(expected.force);
    ASSERT_LT(distance(there.force, expected.force), 2e-3 * force + 5e-5) << i;
    ASSERT_LT(distance(there.torque, expected.torque), kTipRadius * (2e-3 * force + 5e-5)) << i;
    ASSERT_LT(distance(held.tool(), pose.apply(held_at_rest.tool())), 1e-5 * force + 3e-7) << i;
    most = std::fmax(most, length(there.force));
  }
  EXPECT_GT(most, 0.1);
  RigidMotion none{&box.view, {}};
  none.pose.rotation[4] = std::numeric_limits<double>::quiet_NaN();
  const Tick fault = held.tick(contact, probing(0), kTick, none);
  EXPECT_EQ(fault.state, State::fault);
  EXPECT_EQ(fault.fault, Fault::bad_pose);
  EXPECT_EQ(length(fault.force), 0);
}

TEST(VirtualCoupling, HandAtRestOnABodyOfARoundedPoseHasAConstantForce) {
  const Opened box(box_content({}));
  RigidMotion body{&box.view, turned(1.2, unit(Vec3{1, 2, -1}, {}), {0.4, -0.2, 1.1})};
  for (double& r : body.pose.rotation) r = static_cast<float>(r);
  Contact contact(box.view, 0);
  VirtualCoupling held(coupling(500));
  const auto tick = [&](double depth, double aside) {
    return held.tick(contact, orthonormal(body.pose) * upright(centre(depth, aside)), kTick, body);
  };
  for (int k = -10; k <= 100; ++k) tick(3e-5 * k, 0);
  for (int k = 0; k <= 300; ++k) tick(0.003, 2e-6 * std::min(k, 100));
  const Vec3 felt = tick(0.003, 2e-4).force, tool = held.tool();
  EXPECT_GT(length(felt), 0.1);
  for (int k = 0; k < 3000; ++k) {
    ASSERT_LT(distance(tick(0.003, 2e-4).force, felt), 1e-9) << k;
    ASSERT_LT(distance(held.tool(), tool), 1e-12) << k;
  }
}

TEST(VirtualCoupling, ChangingStiffnessFactorsGiveTheHandNoEnergy) {
  const Opened box(box_content({}));
  std::vector<runtime::SiteScales::Scale> memory(box.view.meta->site_count);
  runtime::SiteScales scales(box.view, memory.data());
  const runtime::StiffnessScale<runtime::StillBody> body{{&box.view}, &scales, &box.view};
  for (const double stiffness : {150.0, 1e8}) {
    Contact contact(box.view, 0), plain(box.view, 0);
    VirtualCoupling held(coupling(stiffness));
    Wandering wandering(12);
    std::mt19937 random(12);
    Loops loops;
    for (int i = 0; i < 20000; ++i) {
      if (i % 100 == 0) {
        const auto site = static_cast<std::uint32_t>(random() % box.view.meta->site_count);
        scales.set(site, 1e-3f * static_cast<float>(random() % 2000));
      }
      const Pose pose = upright(wandering.next().translation);
      const Vec3 force = held.tick(contact, pose, kTick, body).force, stiff = plain.tick(pose, body).force;
      loops.add(pose.translation, force);
      ASSERT_TRUE(stiffness < 1e6 || distance(force, stiff) < 2e-3 * length(stiff) + 2e-3) << i;
    }
    EXPECT_GT(loops.touches, 20);
    EXPECT_GT(loops.taken, 1e-3);
    EXPECT_LT(loops.given, 1e-5) << stiffness;
  }
}

TEST(VirtualCoupling, SearchOfEveryTickGivesTheForceOfOwnSearches) {
  const Opened box(box_content({}));
  Contact served(box.view, 0), alone(box.view, 0);
  VirtualCoupling held(coupling(300)), other(coupling(300));
  double most = 0;
  for (int i = 0; i < 2000; ++i) {
    const double t = 2e-3 * i;
    const Pose pose = upright({0.003 * std::sin(t), 0, kTop + kTipRadius - 0.003 * std::sin(2 * t)});
    const Vec3 a = held.tick(served, pose, kTick, runtime::search(box.view, 0, pose)).force;
    const Vec3 b = other.tick(alone, pose, kTick).force;
    ASSERT_LT(distance(a, b), 5e-3) << i;
    most = std::fmax(most, length(a));
  }
  EXPECT_GT(most, 0.1);
}

TEST(VirtualCoupling, ContactSetOfOneWallGivesTheForceOfAContact) {
  const Opened box(box_content({}));
  runtime::ContactSet<3> set(box.view, 0);
  Contact contact(box.view, 0);
  VirtualCoupling held(coupling(300)), other(coupling(300));
  for (int i = 0; i < 3000; ++i) {
    const Pose pose = probing(kTick * i);
    ASSERT_LT(distance(held.tick(set, pose, kTick).force, other.tick(contact, pose, kTick).force), 1e-9) << i;
  }
}

TEST(VirtualCoupling, TimeZeroRepeatsTheLastTickAtMostEightTimes) {
  const Opened box(box_content({}));
  Contact once(box.view, 0), twice(box.view, 0);
  VirtualCoupling held(coupling(200, 0.1)), same(held);
  Tick tick;
  for (int i = 0; i < 4000; ++i) {
    const Pose pose = probing(kTick * i);
    tick = same.tick(twice, pose, kTick);
    const Tick expected = held.tick(once, pose, kTick);
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
  int repeats = 0;
  while (length(same.tick(twice, pressed, 0).force) > 0 && repeats < 100) ++repeats;
  EXPECT_EQ(repeats, same.kRepeats);
  for (int i = 0; i < 100; ++i) {
    tick = same.tick(twice, pressed, 0);
    ASSERT_EQ(tick.state, State::fault);
    ASSERT_EQ(tick.fault, Fault::bad_time);
  }
  EXPECT_EQ(length(same.tick(twice, pressed, kTick).force), 0) << "the contact begins anew";
}

TEST(VirtualCoupling, StateIsStickWhileTheSpringHoldsTheHand) {
  Options options;
  options.tools = Options::Tools::mesh;
  options.search = true;
  const Opened box(box_content(options));
  CouplingOptions hasty = coupling(2000);
  hasty.trials = 2;
  Contact contact(box.view, 0);
  VirtualCoupling held(hasty);
  std::mt19937 random(17);
  int off = 0;
  const double high = runtime::ToolShape<>(box.view, 0).extent() + 0.001;
  for (int stroke = 0; stroke < 80; ++stroke) {
    const Vec3 turn = random_direction(random), way = 5e-4 * random_direction(random);
    Pose pose = turned(3 * turn.x, random_direction(random), {0.01 * turn.y, 0.01 * turn.z, kTop + high});
    contact.reset();
    held.reset();
    for (int i = 0; i < 60; ++i) {
      pose.translation = pose.translation + (i < 30 ? 1 : -1) * Vec3{way.x, way.y, -std::fabs(way.z) - 1e-4};
      const Tick tick = held.tick(contact, pose, kTick);
      if (!(length(tick.force) > 0)) continue;
      ASSERT_TRUE(tick.touches()) << stroke << ' ' << i;
      EXPECT_LT(std::fabs(runtime::closest_point(box.view, tick.body_point).signed_distance), 1e-6);
      off += tick.depth == 0;
      if (tick.depth == 0) {
        ASSERT_EQ(length(tick.torque) + tick.friction_limit + tick.counted_depth, 0);
      }
    }
  }
  EXPECT_GT(off, 10);
}

}  // namespace
}  // namespace palpate::coupling_test
