// SPDX-License-Identifier: GPL-3.0-or-later
// A ball and a rod over hollows, grooves, fissures and ridges: the depth is the overlap, forces turn at a bounded rate, what
// leaves the body is free.
#include <algorithm>
#include <cmath>

#include "tests/runtime/property/hand.hpp"
#include "tests/runtime/support.hpp"
#include "tests/support/concave_samples.hpp"

namespace palpate::concave_test {
namespace {

using namespace test;
using runtime::Contact;
using property::Random;

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
    options.friction = options.bias = mu > 0;
    ResponseFileContent made = concave_content(shape, options);
    if (mu > 0) set_friction(made, mu);
    return made;
  }
};

/// m, by which the tip overlaps the body.
double overlap(const Rough& body, const Vec3& at) { return kTipRadius - closest_point(body.view, at).signed_distance; }

/// A hand that goes down to some depth scales below the top, across, and up; `see` is called in every tick.
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

/// Promise 4, times the stiffness: of a slow tool that keeps its direction.
double most_per_metre(double mu) { return mu >= 1 ? 10 : 5; }

/// Largest change of the force in a tick over the way of the tool and of the response (N/m): promise 3.
class Steepest {
public:
  void add(const Contact& contact, double stride) {
    const runtime::ContactState& now = contact.state();
    const double crept = now.touching && last_.touching ? runtime::response_way(last_.place, now.place) : 0;
    const Vec3 force = now.touching ? now.applied.force : Vec3{};
    value_ = std::max(value_, distance(force, last_.applied.force) / (stride + crept));
    last_ = now;
    last_.applied.force = force;
  }
  /// The next tick is that of a new contact.
  void begin() { last_.reset(); }
  [[nodiscard]] double value() const { return value_; }

private:
  runtime::ContactState last_;
  double value_ = 0;
};

TEST(Concave, DepthIsTheOverlapAndStepsAreBounded) {
  for (const char* name : {"groove_40", "groove_90", "dent", "trough", "wall", "ridge_30", "ridge_15", "slit", "fissure"}) {
    for (const double mu : {0.0, 0.3, 1.0}) {
      const ConcaveShape shape = shape_named(name);
      const Rough body(shape, mu);
      Contact contact(body.view, 0);
      constexpr double kStride = 1e-5;
      double off = 0, strongest = 0, resting = 0;
      int ticks = 0;
      Steepest steepest;
      draw_across(contact, shape.reach, kStride, [&](const Vec3& at, const Tick& tick) {
        if (++ticks % 20 == 0) {
          Contact still = contact;
          resting = std::max(resting, distance(still.tick(upright(at)).force, tick.force));
        }
        if (tick.touches()) off = std::max(off, std::fabs(tick.depth - overlap(body, at)));
        steepest.add(contact, kStride);
        strongest = std::max(strongest, length(tick.force));
      });
      EXPECT_LT(off, 1e-7) << name << ' ' << mu;
      EXPECT_LT(steepest.value(), 2.5 * stiffest(body.view, 0).within) << name << ' ' << mu;
      EXPECT_LT(strongest, 2) << name << ' ' << mu;
      EXPECT_EQ(resting, 0) << name << ' ' << mu << ": a hand at rest loses nothing";
    }
  }
}

TEST(Concave, TopBeyondAGrooveIsFeltAsBeforeIt) {
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

TEST(Concave, DeepPressOverALipHasNoStepAndGivesNoEnergy) {
  for (const char* name : {"groove_40", "groove_90", "dent", "slit", "fissure"}) {
    for (const double mu : {0.0, 0.3, 1.0}) {
      for (const double stride : {1e-5, 2e-4}) {
        const ConcaveShape shape = shape_named(name);
        const Rough body(shape, mu);
        Contact contact(body.view, 0);
        runtime::EnergyMeter meter;
        double least = 0;
        Steepest steepest;
        const auto see = [&](const Vec3& at, const Tick& tick) {
          meter.add(upright(at), tick);
          least = std::min(least, meter.given() - meter.returned());
          steepest.add(contact, stride);
        };
        draw_across(contact, shape.reach, stride, see, 1.4);
        EXPECT_LT(steepest.value(), 2.5 * stiffest(body.view, 0).at(1.4 * kDepthScale)) << name << " " << mu << " " << stride;
        EXPECT_GT(least, -1e-6) << name << " " << mu << " " << stride;
      }
    }
  }
}

TEST(Concave, RodOverALipHasNoStep) {
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
        Tick last;
        double deepest = 0;
        Steepest steepest;
        const auto step = [&](const Vec3& way) {
          pose.translation = pose.translation + way;
          last = contact.tick(pose);
          deepest = std::max(deepest, last.depth);
          steepest.add(contact, kStride);
        };
        while (pose.translation.z > -0.05 && !last.touches()) step({0, 0, -kStride});
        for (double in = 0; in < 1.4 * kDepthScale; in += kStride) step({0, 0, -kStride});
        EXPECT_GT(last.depth, 0.9 * kDepthScale) << name;
        for (double x = -shape.reach; x < shape.reach; x += kStride) step({kStride, 0, 0});
        EXPECT_LT(steepest.value(), 2.5 * stiffest(body.view, 1).at(deepest)) << name << " " << mu << " " << lean;
      }
    }
  }
}

TEST(Concave, SlowDrawFromAnywhereHasNoStep) {
  constexpr double kStride = 2e-5;
  for (const char* name : {"dent", "fissure", "groove_40", "trough", "wall"}) {
    for (const double mu : {0.0, 0.3, 1.0}) {
      const Rough body(shape_named(name), mu, true);
      const double k = stiffest(body.view, 0).within;
      Random random(1);
      Steepest steepest;
      int strokes = 0;
      for (int i = 0; i < 150; ++i) {
        const auto at = property::anywhere(body.view, random);
        const Vec3 n = smooth_normal(body.view, at), down = -1 * n,
                   across = runtime::unit(runtime::tangential(random.direction(), n), n);
        Vec3 p = position(body.view, at) + (kTipRadius + 0.1 * kDepthScale) * n;
        if (overlap(body, p) > -1e-5) continue;
        ++strokes;
        Contact contact(body.view, 0);
        steepest.begin();
        const auto go = [&](const Vec3& way, double far) {
          for (double gone = 0; gone < far; gone += kStride) {
            p = p + kStride * way;
            contact.tick(upright(p));
            steepest.add(contact, kStride);
          }
        };
        go(down, random.between(0.2, 0.7) * kDepthScale);
        go(across, 3 * kDepthScale);
      }
      EXPECT_GT(strokes, 50) << name;
      EXPECT_LT(steepest.value(), 2.5 * k) << name << " " << mu;
    }
  }
}

TEST(Concave, ToolLiftedPastAnEdgeIsFree) {
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
    EXPECT_LT(held, 1e-9) << name;
    EXPECT_GT(least, -1e-6) << name;
  }
}

TEST(Concave, BallRollsIntoACornerWithoutAStep) {
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
      EXPECT_LT(largest, 2.5) << name << " " << side * x;
    }
  }
}

TEST(Concave, FastToolThatLeftTheBodyIsFree) {
  for (const ConcaveShape& shape : concave_shapes()) {
    if (shape.name == "sheet") continue;  // so thin that a stroke passes it
    const Rough body(shape, 0, true);
    std::mt19937 random(3);
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int run = 0; run < 60; ++run) {
      Contact contact(body.view, 0);
      const double stride = std::pow(10, uniform(-3.5, -2.6));
      Vec3 at{uniform(-1, 1) * shape.reach, uniform(-1, 1) * 0.005, 0.03}, way{0, 0, -1};
      for (int i = 0; i < 400; ++i) {
        if (i % 37 == 36) way = random_direction(random);
        const runtime::Location near = closest_point(body.view, at);
        // Back where it is deeper than a sheet is thick, or far off.
        if (near.signed_distance < 0.2 * kTipRadius || near.signed_distance > 0.03) {
          way =
              (near.signed_distance < 0 || near.signed_distance > 0.03 ? 1.0 : -1.0) * unit(near.point - at, {0, 0, 1});
        }
        at = at + stride * way;
        const double off = closest_point(body.view, at).signed_distance - kTipRadius;
        const Tick tick = contact.tick(upright(at));
        ASSERT_FALSE(off > kDepthScale && length(tick.force) > 0.05)
            << shape.name << ' ' << run << ' ' << i << ": " << length(tick.force) << " N, " << off << " m off";
      }
    }
  }
}

TEST(Concave, ContactsOfASetThatMeetMergeAsTheToolMoves) {
  Options options;
  options.search = true;
  options.tools = Options::Tools::all;
  const Opened dent(concave_content(shape_named("dent"), options));
  for (const std::uint32_t tool : {1U, 2U}) {
    const PropertyCase c{Motion::corner, Driver::set, tool, 5000, 1 + tool, 0.25};
    const PropertyResult r = run_property(dent.view, c);
    EXPECT_EQ(broken_promise(c, r, 0.3), "") << tool << ": step " << r.step;
    EXPECT_GT(r.touching, 500U) << tool;
  }
}

// Promise 4: c leaps a millimetre from wall to wall inside the body, and the response with it.
TEST(Concave, SlowToolHasNoStepPerMetreOfItsOwnWay) {
  for (const char* name : {"groove_40", "groove_90", "dent", "slit", "fissure"}) {
    for (const double depth : {0.5, 1.4}) {
      for (const double mu : {0.0, 0.3, 1.0}) {
        const ConcaveShape shape = shape_named(name);
        const Rough body(shape, mu);
        Contact contact(body.view, 0);
        constexpr double kStride = 1e-5;
        double largest = 0;
        Vec3 last;
        const auto see = [&](const Vec3&, const Tick& tick) {
          largest = std::max(largest, distance(tick.force, last));
          last = tick.force;
        };
        draw_across(contact, shape.reach, kStride, see, depth);
        EXPECT_LT(largest, most_per_metre(mu) * stiffest(body.view, 0).at(depth * kDepthScale) * kStride)
            << name << ' ' << depth << ' ' << mu;
      }
    }
  }
}

}  // namespace
}  // namespace palpate::concave_test
