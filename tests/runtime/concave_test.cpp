// SPDX-License-Identifier: GPL-3.0-or-later
// A ball drawn slowly over hollows and grooves with a friction that holds it to their walls: it is not held past their
// edges.
#include <algorithm>
#include <cmath>

#include "tests/runtime/battery.hpp"
#include "tests/runtime/battery_hand.hpp"
#include "tests/runtime/support.hpp"
#include "tests/support/concave_samples.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;

ConcaveShape shape_named(const std::string& name) {
  for (const ConcaveShape& shape : concave_shapes()) {
    if (shape.name == name) return shape;
  }
  ADD_FAILURE() << name;
  return {};
}

struct Rough : Opened {
  explicit Rough(const ConcaveShape& shape, double mu = 1, bool uniform = false)
      : Opened(content(shape, mu, uniform)) {}

  static ResponseFileContent content(const ConcaveShape& shape, double mu, bool uniform) {
    Options options;
    options.uniform = uniform;
    options.search = true;
    options.friction = options.lateral = mu > 0;
    ResponseFileContent made = concave_content(shape, options);
    set_friction(made, mu);
    return made;
  }
};

/// m, by which the tip overlaps the body.
double overlap(const Rough& body, const Vec3& at) { return kTipRadius - locate(body.view, at).signed_distance; }

/// A hand that goes down to some depth scales below the top, across, and up; `see` is told of every tick.
template <class See>
void draw_across(Contact& contact, double reach, double stride, const See& see, double depth = 0.5) {
  const double low = kTipRadius - depth * kDepthScale;
  const double down = 0.0005 + depth * kDepthScale;
  Vec3 at{-reach, 7e-4, low + down};
  const auto go = [&](const Vec3& step, double way) {
    for (double gone = 0; gone < way; gone += stride) {
      at = at + stride * step;
      see(at, contact.tick(upright(at)));
    }
  };
  go({0, 0, -1}, down);
  go({1, 0, 0}, 2 * reach);
  go({0, 0, 1}, 0.02);
}

// With a friction of 1 a wall holds what leans on it from any side. Once the tool is past its edge that pushed 13 mm
// deep where the skin overlaps 2.5 mm, until it let go at once: 7 N in a tick.
TEST(Concave, PastAnEdgeATipIsPushedAsFarAsItOverlaps) {
  for (const char* name : {"groove_40", "groove_90", "dent", "trough", "wall", "ridge_30", "ridge_15"}) {
    const ConcaveShape shape = shape_named(name);
    const Rough body(shape);
    Contact contact(body.view, 0);
    double deepest = 0, largest = 0, strongest = 0, resting = 0;
    Vec3 last;
    draw_across(contact, shape.reach, 5e-6, [&](const Vec3& at, const Tick& tick) {
      if (Contact still = contact; tick.state == State::stick) {
        resting = std::max(resting, distance(still.tick(upright(at)).force, tick.force));
      }
      if (tick.touches()) deepest = std::max(deepest, tick.depth - std::max(0.0, overlap(body, at)));
      largest = std::max(largest, distance(tick.force, last));
      strongest = std::max(strongest, length(tick.force));
      last = tick.force;
    });
    EXPECT_LT(deepest, 0.0012) << name;
    EXPECT_LT(largest, 4.5 * stiffest(body.view, 0).within * 5e-6) << name;
    EXPECT_LT(strongest, 2) << name;
    EXPECT_LT(resting, 1e-9) << name << ": a hand at rest loses nothing";
  }
}

// Beyond a groove the top pushes as it did before it.
TEST(Concave, BeyondAGrooveTheTopIsFeltAsBefore) {
  for (const char* name : {"groove_40", "groove_90", "dent", "trough"}) {
    const ConcaveShape shape = shape_named(name);
    const Rough body(shape);
    Contact contact(body.view, 0);
    double before = 0, beyond = 0;
    int lost = 0, ticks = 0;
    draw_across(contact, shape.reach, 5e-6, [&](const Vec3& at, const Tick& tick) {
      if (at.x < -0.012 && at.x > -0.018) before += tick.force.z;
      if (at.x > 0.012 && at.x < 0.018) {
        beyond += tick.force.z;
        ++ticks;
        lost += !tick.touches();
      }
    });
    EXPECT_EQ(lost, 0) << name;
    EXPECT_GT(beyond, 0.5 * before) << name;
    EXPECT_LT(beyond, 1.3 * before) << name;
  }
}

// Deeper than that c cannot follow over a lip. It stays, and lets go as the tool moves: to leap to what is nearest then
// would turn 3 N round at once.
TEST(Concave, PressedDeepItLetsGoWithoutALeap) {
  for (const char* name : {"groove_40", "groove_90", "dent", "slit", "fissure"}) {
    for (const double mu : {0.0, 0.3, 1.0}) {
      for (const double stride : {1e-5, 2e-4}) {
        const ConcaveShape shape = shape_named(name);
        const Rough body(shape, mu);
        Contact contact(body.view, 0);
        runtime::EnergyMeter meter;
        double largest = 0, least = 0;
        Vec3 last;
        const auto see = [&](const Vec3& at, const Tick& tick) {
          meter.add(upright(at), tick);
          least = std::min(least, meter.given() - meter.returned());
          largest = std::max(largest, distance(tick.force, last));
          last = tick.force;
        };
        draw_across(contact, shape.reach, stride, see, 1.4);
        EXPECT_LT(largest, 4.5 * stiffest(body.view, 0).within * stride) << name << " " << mu << " " << stride;
        EXPECT_GT(least, -1e-6) << name << " " << mu << " " << stride;
      }
    }
  }
}

// So does a rod. One that leans ahead lays itself down where it comes over a lip: p runs along it eight times as far as
// the skin goes, c with it round the lip, and the force turns as fast. Both leapt, by 340 to 1460 times the stiffness
// times the way.
TEST(Concave, ARodLetsGoWithoutALeap) {
  constexpr double kStride = 1e-5;
  Options options;
  options.search = true;
  options.tools = Options::Tools::all;
  for (const char* name : {"groove_40", "groove_90", "dent", "slit", "fissure"}) {
    for (const double mu : {0.3, 1.0}) {
      const ConcaveShape shape = shape_named(name);
      ResponseFileContent made = concave_content(shape, options);
      set_friction(made, mu);
      const Opened body(std::move(made));
      for (const double lean : {0.0, -0.785, 0.785}) {
        Contact contact(body.view, 1);
        Pose pose = turned(lean, {0, 1, 0}, {-shape.reach, 7e-4, 0.08});
        double largest = 0;
        Tick last;
        const auto step = [&](const Vec3& way) {
          pose.translation = pose.translation + way;
          const Tick tick = contact.tick(pose);
          largest = std::max(largest, distance(tick.force, last.force));
          last = tick;
        };
        while (pose.translation.z > -0.05 && !last.touches()) step({0, 0, -kStride});
        for (double in = 0; in < 1.4 * kDepthScale; in += kStride) step({0, 0, -kStride});
        EXPECT_GT(last.depth, 0.9 * kDepthScale) << name;
        for (double x = -shape.reach; x < shape.reach; x += kStride) step({kStride, 0, 0});
        EXPECT_LT(largest, (lean > 0 ? 80 : 4.5) * stiffest(body.view, 1).within * kStride)
            << name << " " << mu << " " << lean;
      }
    }
  }
}

// Drawn slowly from anywhere to anywhere c comes to the bottom of a fold, where the other wall is pressed deeper. It
// leapt there, though its foot was on the surface then, and the force turned by more than a right angle at once.
TEST(Concave, DrawnSlowlyFromAnywhereItDoesNotLeap) {
  constexpr double kStride = 2e-5;
  for (const char* name : {"dent", "fissure", "groove_40", "trough", "wall"}) {
    for (const double mu : {0.0, 0.3, 1.0}) {
      const Rough body(shape_named(name), mu, true);
      const double k = stiffest(body.view, 0).within;
      battery::Random random(1);
      double largest = 0;
      int strokes = 0;
      for (int i = 0; i < 300; ++i) {
        const auto at = battery::anywhere(body.view, random);
        const Vec3 n = normal(body.view, at), down = -1 * n,
                   across = runtime::unit(runtime::tangential(random.direction(), n), n);
        Vec3 p = position(body.view, at) + (kTipRadius + 0.1 * kDepthScale) * n;
        if (overlap(body, p) > -1e-5) continue;
        ++strokes;
        Contact contact(body.view, 0);
        Tick last;
        const auto go = [&](const Vec3& way, double far) {
          for (double gone = 0; gone < far; gone += kStride) {
            p = p + kStride * way;
            const Tick tick = contact.tick(upright(p));
            largest = std::max(largest, distance(tick.force, last.force));
            last = tick;
          }
        };
        go(down, random.between(0.2, 0.7) * kDepthScale);
        go(across, 3 * kDepthScale);
      }
      EXPECT_GT(strokes, 100) << name;
      EXPECT_LT(largest, 4.5 * k * kStride) << name << " " << mu;
    }
  }
}

// What is lifted off the body is free of it, and the hand has paid for all that it felt.
TEST(Concave, ALiftPastAnEdgeIsFree) {
  for (const char* name : {"wall", "ridge_30", "ridge_15"}) {
    const ConcaveShape shape = shape_named(name);
    const Rough body(shape);
    Contact contact(body.view, 0);
    runtime::EnergyMeter meter;
    double held = 0, least = 0;
    draw_across(contact, shape.reach, 5e-6, [&](const Vec3& at, const Tick& tick) {
      meter.add(upright(at), tick);
      least = std::min(least, meter.given() - meter.returned());
      if (overlap(body, at) < -0.1 * kDepthScale) held = std::max(held, length(tick.force));
    });
    EXPECT_LT(held, 1e-9) << name << ": 8 N and more, clear of the body";
    EXPECT_GT(least, -1e-6) << name;
  }
}

// Where a ball rolls into a corner, c cannot go on with it: the anchor does. It went back by all that was rolled, 14
// times as far as its skin and c went.
TEST(Concave, ABallRollsIntoACornerWithoutAStep) {
  constexpr double kTurn = 1e-4;  // rad a tick
  constexpr double kY = 7e-4;
  const struct {
    const char* name;
    double x;
  } kPlaces[] = {{"ridge_30", 0.0075}, {"ridge_30", 0.009}, {"ridge_15", 0.006}};
  for (const auto& [name, x] : kPlaces) {
    const Rough body(shape_named(name));
    const double k = stiffest(body.view, 0).within;
    for (const double side : {-1.0, 1.0}) {
      Contact contact(body.view, 0);
      Tick last;
      double z = 0.02, largest = 0;
      while (z > -0.02 && !(last.depth > 0.5 * kDepthScale)) last = contact.tick(upright({side * x, kY, z -= 1e-5}));
      ASSERT_TRUE(last.touches()) << name << " " << x;
      for (double angle = 0; angle < 0.5; angle += kTurn) {
        const Tick tick = contact.tick(turned(angle, {0, side, 0}, {side * x, kY, z}));
        const double way = kTurn * kTipRadius + distance(tick.body_point, last.body_point);
        largest = std::max(largest, distance(tick.force, last.force) / (k * way));
        last = tick;
      }
      EXPECT_LT(largest, 4.5) << name << " " << side * x;
    }
  }
}

// Strokes of up to 2.5 mm a tick over edges and out of pockets: c waited at an edge, took the tool that had left the
// body for one that went on deeper under its plane, and pushed it 30 mm off with ever more.
TEST(Concave, AFastToolThatLeftTheBodyIsLetGo) {
  for (const ConcaveShape& shape : concave_shapes()) {
    if (shape.name == "sheet") continue;  // so thin that a stroke passes it
    const Rough body(shape, 0, true);
    std::mt19937 random(3);
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int run = 0; run < 120; ++run) {
      Contact contact(body.view, 0);
      const double stride = std::pow(10, uniform(-3.5, -2.6));
      Vec3 at{uniform(-1, 1) * shape.reach, uniform(-1, 1) * 0.005, 0.03}, way{0, 0, -1};
      for (int i = 0; i < 400; ++i) {
        if (i % 37 == 36) way = random_direction(random);
        const runtime::Location near = locate(body.view, at);
        // Back where it is deeper than a sheet is thick, or far off.
        if (near.signed_distance < 0.2 * kTipRadius || near.signed_distance > 0.03) {
          way =
              (near.signed_distance < 0 || near.signed_distance > 0.03 ? 1.0 : -1.0) * unit(near.point - at, {0, 0, 1});
        }
        at = at + stride * way;
        const double off = locate(body.view, at).signed_distance - kTipRadius;
        const Tick tick = contact.tick(upright(at));
        ASSERT_FALSE(off > kDepthScale && length(tick.force) > 0.05)
            << shape.name << ' ' << run << ' ' << i << ": " << length(tick.force) << " N, " << off << " m off";
      }
    }
  }
}

// Of a tool that touches at several places one leaps to where another is: they merge as the tool moves, and what pushes
// more goes on. The other's push was gone at once.
TEST(Concave, ContactsThatMeetAtOnceMergeAsTheToolMoves) {
  Options options;
  options.search = true;
  options.tools = Options::Tools::all;
  const Opened dent(concave_content(shape_named("dent"), options));
  for (const std::uint32_t tool : {1U, 2U}) {
    const BatteryCase c{Motion::fast, Driver::several, tool, 5000, 1 + tool, 0.25};
    const BatteryResult r = run_battery(dent.view, c);
    EXPECT_EQ(broken_promise(c, r), "") << tool << ": step " << r.step;
    EXPECT_GT(r.touching, 1000U) << tool;
  }
}

}  // namespace
}  // namespace palpate
