// SPDX-License-Identifier: GPL-3.0-or-later
// How a contact begins: fast tools have the force of a finer motion, nothing is passed in a tick, late detection.
#include "palpate/contact/first_contact.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/runtime/support.hpp"
#include "tests/support/concave_samples.hpp"

namespace palpate::first_contact_test {
namespace {

using namespace test;
using runtime::Contact;

constexpr int kOffsets = 7;         // of the first tick, over the way of a tick
constexpr double kFastStep = 5e-4;  // m, 0.5 m/s at 1 kHz

using Path = std::function<Pose(double)>;  // by the way gone (m)

Path onward(const Vec3& from, const Vec3& direction) {
  return [=](double way) { return upright(from + way * direction); };
}

// A tick every `step` of the path, the last at its end.
std::vector<Tick> ticks_of(const runtime::View& view, const Path& path, double end, double step) {
  Contact contact(view, 0);
  std::vector<Tick> ticks;
  for (int i = static_cast<int>(end / step + 1e-6); i >= 0; --i) ticks.push_back(contact.tick(path(end - i * step)));
  return ticks;
}

// How far a run is from one of a hundred times finer ticks.
struct Apart {
  double force = 0;   // largest difference, of the peak
  double point = 0;   // of c in the first tick that touches, of the way of a tick
  double begins = 0;  // of the force in that tick, of its own
};

Apart finely_apart(const runtime::View& view, const Path& path, double end, double step) {
  constexpr std::size_t kFiner = 100;
  const std::vector<Tick> ticks = ticks_of(view, path, end, step), fine = ticks_of(view, path, end, step / kFiner);
  double peak = 0;
  for (const Tick& tick : fine) peak = std::max(peak, length(tick.force));
  EXPECT_GT(peak, 0.1);
  Apart result;
  for (std::size_t back = 0; back < ticks.size(); ++back) {
    const Tick &a = ticks[ticks.size() - 1 - back], &b = fine[fine.size() - 1 - kFiner * back];
    result.force = std::max(result.force, distance(a.force, b.force) / peak);
    if (!a.touches() || !b.touches()) break;
    result.point = distance(a.body_point, b.body_point) / step;
    result.begins = distance(a.force, b.force) / length(b.force);
  }
  return result;
}

// The worst of several offsets, of paths that touch 4 mm and more after they begin and go `in` (m) from there.
Apart worst_apart(const runtime::View& view, const std::function<Path(double)>& before, double in, double step) {
  Apart most;
  for (int k = 0; k < kOffsets; ++k) {
    const double out = 0.004 + step * k / kOffsets;
    const Apart one = finely_apart(view, before(out), out + in, step);
    most = {std::max(most.force, one.force), std::max(most.point, one.point), std::max(most.begins, one.begins)};
  }
  return most;
}

// From where a ball touches the box or the ball of the samples, so far back against its direction.
std::function<Path(double)> onto(const Vec3& touch, const Vec3& direction) {
  return [=](double out) { return onward(touch - out * direction, direction); };
}

const Vec3 kOnBox{0.001, 0.002, kTop + kTipRadius};
const Vec3 kUp = unit(Vec3{0.3, 0.2, 0.9}, {}), kOnBall = (kBallRadius + kTipRadius) * kUp;
// 60 degrees from the normals there.
const Vec3 kAskewOnBox = unit(Vec3{1.7, 0.3, -1}, {});
const Vec3 kAskewOnBall = unit(Vec3{1.7, 0, 0} - dot(Vec3{1.7, 0, 0}, kUp) * kUp - kUp, {});

Options alike(bool friction) {
  Options options = uniform();
  options.bias = false;
  options.friction = friction;
  options.subdivision = 4;
  options.search = true;
  return options;
}

// Nothing slips on it.
ResponseFileContent rough(ResponseFileContent content) {
  set_friction(content, 9);
  return content;
}

TEST(FirstContact, StraightPressHasTheSameForceAtAnySpeed) {
  constexpr double kIn = 0.003;
  for (const bool friction : {false, true}) {
    const Options options = alike(friction);
    const Opened box(box_content(options)), ball(ball_content(options));
    const double on_ball =
        length(ticks_of(ball.view, onward(kOnBall + 0.001 * kUp, -kUp), 0.001 + kIn, 1e-5).back().force);
    for (const double step : {1e-5, 1e-4, kFastStep, 1e-3}) {
      for (int k = 0; k < kOffsets; ++k) {
        const double out = 0.001 + step * k / kOffsets;
        const Tick there = ticks_of(box.view, onward(kOnBox + Vec3{0, 0, out}, {0, 0, -1}), out + kIn, step).back();
        EXPECT_NEAR(there.depth, kIn, 1e-3 * step) << step << ' ' << k;
        EXPECT_NEAR(length(there.force), hertz(kIn), 1e-3 * hertz(kIn)) << step << ' ' << k << ' ' << friction;
        const Tick round = ticks_of(ball.view, onward(kOnBall + out * kUp, -kUp), out + kIn, step).back();
        EXPECT_NEAR(length(round.force), on_ball, 5e-3 * on_ball) << step << ' ' << k << ' ' << friction;
      }
    }
  }
}

TEST(FirstContact, ObliqueContactLiesWhereTheToolTouchedFirst) {
  const Opened box(rough(box_content(alike(true)))), ball(rough(ball_content(alike(true))));
  const Apart flat = worst_apart(box.view, onto(kOnBox, kAskewOnBox), 0.003, kFastStep);
  const Apart round = worst_apart(ball.view, onto(kOnBall, kAskewOnBall), 0.003, kFastStep);
  // c goes to the foot less the deflection of the last tick, so it is ahead by at most one tick's way.
  EXPECT_LT(flat.point, 1);
  EXPECT_LT(round.point, 1);
  EXPECT_LT(flat.begins, 0.2);
  EXPECT_LT(round.begins, 0.2);
}

TEST(FirstContact, ObliqueForceIsThatOfAFinerMotion) {
  for (const bool friction : {false, true}) {
    const Opened box(box_content(alike(friction))), ball(ball_content(alike(friction)));
    const Apart flat = worst_apart(box.view, onto(kOnBox, kAskewOnBox), 0.006, kFastStep);
    const Apart round = worst_apart(ball.view, onto(kOnBall, kAskewOnBall), 0.006, kFastStep);
    EXPECT_LT(flat.force, 0.02) << friction;
    EXPECT_LT(round.force, 0.02) << friction;
  }
}

// A stem that comes down leaning, and one that swings down about its far end; the corner of a mesh.
TEST(FirstContact, CapsulesAndMeshesHaveTheForceOfAFinerMotion) {
  Options options = alike(false);
  options.tools = Options::Tools::capsule;
  const Opened rods(box_content(options));
  options.tools = Options::Tools::mesh;
  const Opened gems(box_content(options));
  const auto leaning = [](double angle, double height) {
    return turned(angle, {0, 1, 0}, {-0.01, 0.001, kTop + height});
  };
  const double down = 0.003;
  const auto fall = [&](double out) -> Path {
    return [=](double way) { return leaning(0.7, kTipRadius + out - way); };
  };
  const auto swing = [&](double out) -> Path {
    return [=](double way) {
      const Pose lying = turned(std::numbers::pi / 2 - (way - out) / kStemLength, {0, 1, 0}, {});
      const Vec3 far{0.02, 0.001, kTop + kTipRadius + 0.001};
      Pose pose = lying;
      pose.translation = far - lying.rotate({0, 0, kStemLength});
      return pose;
    };
  };
  const auto corner = [&](double out) -> Path {
    return [=](double way) { return upright({0.001 + 0.3 * way, 0.002, kTop + 0.004 + out - way}); };
  };
  EXPECT_LT(worst_apart(rods.view, fall, down, kFastStep).force, 0.02);
  EXPECT_LT(worst_apart(rods.view, swing, down, kFastStep).force, 0.02);
  EXPECT_LT(worst_apart(gems.view, corner, down, kFastStep).force, 0.02);
}

TEST(FirstContact, OverlapWithoutAMotionBeginsWithoutForce) {
  const Opened box(box_content(alike(true)));
  const auto at = [](double depth) { return upright(kOnBox - Vec3{0, 0, depth}); };
  Pose wrong = at(0);
  wrong.rotation[0] = 2;
  Contact started(box.view, 0), reset(box.view, 0), broken(box.view, 0), put(box.view, 0), leapt(box.view, 0);
  reset.tick(at(-0.0001));
  reset.reset();
  broken.tick(at(-0.0001));
  broken.tick(wrong);
  put.tick(at(-0.0001 - put.size(kDepthScale)));
  for (double depth = -0.001; depth < 0.002; depth += 1e-4) leapt.tick(at(depth));
  leapt.tick(at(0.003 - 1.01 * leapt.size(kDepthScale)));
  leapt.tick(at(-0.02));
  for (Contact* contact : {&started, &reset, &broken, &put, &leapt}) {
    const auto number = contact - &started;
    EXPECT_EQ(length(contact->tick(at(0.003)).force), 0) << number;
    EXPECT_NEAR(contact->tick(at(0.004)).counted_depth, 0.001, 1e-8) << number;
  }
}

// The last search found no body; the tool went on into one meanwhile.
TEST(FirstContact, OldSearchCountsTheMotionSinceTheLastTick) {
  const Opened box(box_content(alike(true)));
  const auto at = [](double depth) { return upright(kOnBox - Vec3{0, 0, depth}); };
  Contact contact(box.view, 0);
  runtime::Search old = runtime::search(box.view, 0, at(-0.002));
  old.touch.safe = HUGE_VAL;
  for (int i = -4; i < 4; ++i) EXPECT_EQ(length(contact.tick(at(i * kFastStep), old).force), 0);
  const Tick seen = contact.tick(at(4 * kFastStep), runtime::search(box.view, 0, at(4 * kFastStep)));
  EXPECT_TRUE(seen.touches());
  EXPECT_NEAR(seen.counted_depth, kFastStep, 1e-6);
}

// A sheet of 1 mm, its top at 0, for one tool whose tip is as large: a ball, a rod, or a gem with so much from its
// middle to its corners.
ResponseFileContent sheet_content(Options options, double tip) {
  options.search = true;
  ResponseFileContent content;
  for (const ConcaveShape& shape : concave_shapes()) {
    if (shape.name == "sheet") content = concave_content(shape, options);
  }
  ResponseTool& tool = content.tools[0];
  const double smaller = tip / tool.radius;
  tool.radius = tip;
  tool.probe_radius *= smaller;
  for (auto& vertex : tool.vertices) {
    const bool stem = vertex.point[2] == kStemLength;
    for (double& x : vertex.point) x *= smaller;
    vertex.meridian *= smaller;
    if (!stem) continue;
    vertex.point[2] = kStemLength;
    vertex.meridian = tip * std::numbers::pi / 2 + kStemLength;
  }
  return content;
}

constexpr double kTips[] = {2e-3, 5e-3}, kFastSteps[] = {1e-3, 1.2e-3, 2e-3, 3e-3, 4.9e-3};
constexpr int kPushes = 50;

// Pushes that come from 6 mm above the sheet, one tick's way after the other, and end with the core above it: none is
// missed, and the force is that of a finer motion.
void expect_felt(Options::Tools kind, double angle, const Vec3& start, const Vec3& aside) {
  Options options = alike(false);
  options.tools = kind;
  for (const double tip : kTips) {
    const Opened sheet(sheet_content(options, tip));
    const bool mesh = kind == Options::Tools::mesh;
    const double deepest = mesh ? 4e-4 : std::min(0.9 * tip, 0.003);  // a mesh is its own core
    for (const double step : kFastSteps) {
      int felt = 0;
      for (int k = 0; k < kPushes; ++k) {
        const Path down = [&](double way) {
          return turned(angle, {0, 1, 0}, start + Vec3{0, 0, 0.006 + tip} + way * aside - Vec3{0, 0, way});
        };
        const double end = 0.006 + deepest * (1 + k % 7) / 7, longer = std::hypot(length(aside), 1);
        const double fast = step / longer * (1 - 0.3 * k / kPushes);
        const Tick there = ticks_of(sheet.view, down, end, fast).back();
        felt += there.touches() && there.force.z > 0;
        if (k % 10 != 0) continue;
        const Tick slow = ticks_of(sheet.view, down, end, fast / 100).back();
        EXPECT_GT(slow.force.z, 0);
        EXPECT_LT(distance(there.force, slow.force), 0.05 * length(slow.force)) << tip << ' ' << step << ' ' << k;
      }
      EXPECT_EQ(felt, kPushes) << tip << ' ' << step;
    }
  }
}

TEST(FirstContact, BallDoesNotPassASheetInATick) {
  expect_felt(Options::Tools::sphere, 0, {0.003, 0.002, 0}, {});
  expect_felt(Options::Tools::sphere, 0, {0.003, 0.002, 0}, {0.8, 0.3, 0});
}

TEST(FirstContact, RodDoesNotPassASheetInATick) {
  expect_felt(Options::Tools::capsule, 0, {0.003, 0.002, 0}, {});
  expect_felt(Options::Tools::capsule, 0.5, {0.003, 0.002, 0}, {0.4, 0, 0});
}

TEST(FirstContact, MeshDoesNotPassASheetInATick) {
  expect_felt(Options::Tools::mesh, 0, {0.003, 0.002, 0}, {});
}

TEST(FirstContact, FastToolOnASheetStoresTheEnergyOfASlowOne) {
  const Opened sheet(sheet_content(alike(true), kTips[1]));
  const Path down = onward({0.003, 0.002, 0.007}, unit(Vec3{0.5, 0, -1}, {}));
  const auto stored = [&](double step) {
    Contact contact(sheet.view, 0);
    for (double way = 0; way < 0.0055; way += step) contact.tick(down(way));
    contact.tick(down(0.0055));
    return contact.state().energy.energy();
  };
  const double slow = stored(1e-5);
  EXPECT_GT(slow, 1e-4);
  EXPECT_NEAR(stored(4.9e-3), slow, 0.1 * slow);
}

TEST(FirstContact, ToolThatIsPutBehindASheetIsFree) {
  const Opened sheet(sheet_content(alike(false), 2e-4));
  Contact contact(sheet.view, 0);
  const auto at = [](double height) { return upright({0.003, 0.002, height}); };
  EXPECT_FALSE(contact.tick(at(0.002)).touches());
  EXPECT_FALSE(contact.tick(at(0.002 - 1.01 * contact.size(kDepthScale))).touches());
  EXPECT_TRUE(contact.tick(at(0.00015)).touches());
}

}  // namespace
}  // namespace palpate::first_contact_test
