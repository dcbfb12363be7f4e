// SPDX-License-Identifier: GPL-3.0-or-later
// Output chain and device frame: limits, filters, projections, wrong input, work between hand and scene.
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "palpate/math/rotation.hpp"
#include "palpate/output/device_frame.hpp"
#include "palpate/output/output_chain.hpp"
#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::DeviceFrame;
using runtime::OutputChain;
namespace output = runtime::output;

constexpr double kTick = 1e-3, kPi = 3.14159265358979;

// Forces of a random walk whose steps are now and then far too long.
struct Walk {
  std::mt19937 random{21};
  Vec3 force;
  const Vec3& next() {
    const bool leap = random() % 20 == 0;
    force = 0.98 * force + (leap ? 8.0 : 0.2) * random_direction(random);
    return force;
  }
};

TEST(OutputChain, WithoutStepsReturnsItsInput) {
  static_assert(std::is_empty_v<OutputChain<>>);
  OutputChain<> plain;
  EXPECT_EQ(distance(plain({1, -2, 3}, kTick), {1, -2, 3}), 0);
}

TEST(OutputChain, LimitBoundsTheMagnitudeAndKeepsTheDirection) {
  OutputChain<output::Limit> out({3.0});
  Walk walk;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 in = walk.next(), given = out(in, kTick);
    ASSERT_LE(length(given), 3 * (1 + 1e-15));
    ASSERT_LT(length(cross(given, in)), 1e-14 * (1 + dot(in, in)));
    ASSERT_GE(dot(given, in), 0);
    if (length(in) <= 3) {
      ASSERT_EQ(distance(in, given), 0);
    }
  }
}

TEST(OutputChain, RateLimitBoundsTheChangeAndReachesTheInput) {
  OutputChain<output::RateLimit> out({400.0});
  Walk walk;
  Vec3 last;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 given = out(walk.next(), kTick);
    ASSERT_LE(distance(given, last), 0.4 * (1 + 1e-12));
    last = given;
  }
  int ticks = 0;
  while (distance(last, {5, 0, 0}) > 0 && ticks < 1000) {
    const Vec3 given = out({5, 0, 0}, kTick);
    ASSERT_LT(length(cross(given - last, Vec3{5, 0, 0} - last)), 1e-12);  // straight there
    last = given;
    ++ticks;
  }
  EXPECT_LT(ticks, 60);
}

// Amplitude of a sine's answer after it has settled.
double gain(double cut, double frequency, double tick) {
  OutputChain<output::LowPass> out({cut});
  double most = 0;
  const int ticks = static_cast<int>(20 / frequency / tick);
  for (int i = 0; i < ticks; ++i) {
    const double given = out({std::sin(2 * kPi * frequency * i * tick), 0, 0}, tick).x;
    if (i > ticks / 2) most = std::fmax(most, std::fabs(given));
  }
  return most;
}

TEST(OutputChain, LowPassIsOfFirstOrderAtAnyTickRate) {
  for (const double tick : {1e-4, 2.5e-5}) {
    EXPECT_NEAR(gain(50, 1, tick), 1, 2e-3);
    EXPECT_NEAR(gain(50, 50, tick), std::sqrt(0.5), 0.02);
    EXPECT_NEAR(gain(50, 500, tick), 1 / std::sqrt(101), 0.02);
  }
  OutputChain<output::LowPass> out({50});
  Vec3 given;
  for (int i = 0; i < 1000; ++i) given = out({0.3, -2, 1}, kTick);
  EXPECT_LT(distance(given, {0.3, -2, 1}), 1e-12);
}

// Each component for itself: one may rest while another is held.
TEST(OutputChain, LowPassReachesAConstantInputExactly) {
  for (const Vec3& held : {Vec3{}, Vec3{0, 0, 1}}) {
    OutputChain<output::LowPass> out({30});
    for (int i = 0; i < 100; ++i) (void)out({2, -1, 1}, kTick);
    Vec3 given{1, 1, 1};
    int ticks = 0;
    for (; distance(given, held) > 0 && ticks < 1000; ++ticks) given = out(held, kTick);
    EXPECT_NEAR(ticks, std::log(std::hypot(2, 1, 1 - held.z) / 1e-12) / (2 * kPi * 30 * kTick), 2);
  }
}

TEST(OutputChain, ProjectionsRemoveDirectionsWithoutActuator) {
  std::mt19937 random(22);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 axis = random_direction(random), force = 4 * random_direction(random);
    OutputChain<output::OneAxis> one({axis}), pulls({axis, true});
    OutputChain<output::TwoAxes> two({axis});
    ASSERT_LT(distance(one(force, kTick) + two(force, kTick), force), 1e-14);
    ASSERT_NEAR(dot(two(force, kTick), axis), 0, 1e-14);
    ASSERT_LT(distance(pulls(force, kTick), dot(force, axis) > 0 ? one(force, kTick) : Vec3{}), 1e-15);
  }
}

TEST(OutputChain, StepsAreAppliedInTheirOrder) {
  OutputChain<output::OneAxis, output::Limit> first({{0, 0, 1}}, {1.0});
  EXPECT_LT(distance(first({3, 0, 4}, kTick), {0, 0, 1}), 1e-15);
  OutputChain<output::Limit, output::OneAxis> then({1.0}, {{0, 0, 1}});
  EXPECT_LT(distance(then({3, 0, 4}, kTick), {0, 0, 0.8}), 1e-15);
}

// A fault in the scene or in the clock must neither reach the device nor stay in a filter.
TEST(OutputChain, InvalidInputGivesZeroAndResetsTheSteps) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  const auto make = [] { return OutputChain<output::LowPass, output::RateLimit, output::Limit>({80}, {500}, {3}); };
  const std::pair<Vec3, double> bad[] = {{{kNan, 0, 0}, kTick}, {{0, kInf, 0}, kTick}, {{0, 0, 1e300}, kTick},
                                         {{kNan, 0, 0}, 0},     {{1, 0, 0}, -1},       {{1, 0, 0}, kNan},
                                         {{1, 0, 0}, kInf}};
  for (const auto& [force, seconds] : bad) {
    auto out = make(), fresh = make();
    for (int i = 0; i < 100; ++i) (void)out({1, 1, 0}, kTick);
    EXPECT_EQ(length(out(force, seconds)), 0);
    EXPECT_EQ(distance(out({0, 2, 0}, kTick), fresh({0, 2, 0}, kTick)), 0);
  }
}

// No time went by, so no filter may have, either; nor may a clock that stands still hold a force.
TEST(OutputChain, RepeatedSampleRepeatsTheOutputAtMostEightTimes) {
  OutputChain<output::LowPass, output::RateLimit, output::Limit> once({80}, {100}, {3}), twice = once;
  Walk walk;
  for (int i = 0; i < 500; ++i) {
    const Vec3 force = walk.next(), given = twice(force, kTick);
    ASSERT_EQ(distance(given, once(force, kTick)), 0);
    for (int again = 0; again < i % 4; ++again) ASSERT_EQ(distance(twice(walk.next(), 0), given), 0);
  }
  (void)twice({1, 2, 3}, kTick);
  int held = 0;
  while (length(twice({1, 2, 3}, 0)) > 0 && held < 100) ++held;
  EXPECT_EQ(held, twice.kRepeats);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(length(twice({1, 2, 3}, 0)), 0);
  once.reset();
  for (int i = 0; i < 10; ++i) ASSERT_EQ(distance(twice({1, 2, 3}, kTick), once({1, 2, 3}, kTick)), 0);
}

template <class... Steps>
void refused(const char* wrong, const Steps&... steps) {
  OutputChain<Steps...> out(steps...);
  ASSERT_NE(out.validate(), nullptr);
  EXPECT_NE(std::strstr(out.validate(), wrong), nullptr) << out.validate();
  for (int i = 0; i < 10; ++i) EXPECT_EQ(length(out({3, -4, 5}, kTick)), 0) << wrong;
}

TEST(OutputChain, WrongParameterIsNamedAndGivesZeroForce) {
  using namespace output;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double most : {kNan, -1.0}) refused("force limit", Limit{most});
  for (const double most : {kNan, -1.0, 0.0}) {
    refused("rate", RateLimit{most});
    refused("low-pass", LowPass{most});
  }
  for (const Vec3& axis : {Vec3{}, Vec3{0, 0, 2}, Vec3{1, 1, 0}, Vec3{kNan, 0, 1}}) {
    refused("actuated direction", OneAxis{axis});
    refused("without actuator", TwoAxes{axis});
  }
  // The first of several that is wrong; own steps have validate(), too.
  struct Twice {
    [[nodiscard]] const char* validate() const { return nullptr; }
    Vec3 operator()(const Vec3& force, double) const { return 2 * force; }
    void reset() {}
  };
  refused("low-pass", Twice{}, LowPass{-1}, Limit{-1});
  refused("limit", LowPass{80}, RateLimit{100}, Twice{}, Limit{-1});
  constexpr double kInf = std::numeric_limits<double>::infinity();
  OutputChain<Limit, LowPass, RateLimit, Twice> open({kInf}, {kInf}, {kInf}, {});
  EXPECT_EQ(open.validate(), nullptr);
  EXPECT_EQ(distance(open({3, -4, 5}, kTick), {6, -8, 10}), 0);
  EXPECT_EQ(length(OutputChain<Limit>({0})({1, 2, 3}, kTick)), 0);
  EXPECT_EQ(OutputChain<>().validate(), nullptr);
}

TEST(DeviceFrame, HandAndSceneDoTheSameWork) {
  std::mt19937 random(23);
  const auto turned = [&] {
    const Vec3 axis = random_direction(random);
    return Pose::from_quaternion(0.3, axis.x, axis.y, axis.z, random_direction(random));
  };
  for (int i = 0; i < 200; ++i) {
    const DeviceFrame frame{turned(), 3, 3};
    const Pose hand = turned();
    Pose moved = hand;
    const Vec3 step = 1e-3 * random_direction(random), force = random_direction(random);
    moved.translation = moved.translation + step;
    const Pose a = frame.to_scene(hand), b = frame.to_scene(moved);
    ASSERT_TRUE(a.valid());
    ASSERT_NEAR(distance(a.translation, b.translation), 3e-3, 1e-15);
    // The hand's work is the scene's where both have one scale.
    ASSERT_NEAR(dot(frame.to_device(force), step), dot(force, b.translation - a.translation), 1e-15);
    // So is what a turn does.
    const Vec3 turn = 1e-3 * random_direction(random), torque = random_direction(random);
    ASSERT_NEAR(dot(frame.torque_to_device(torque), turn), dot(torque, frame.pose.rotate(turn)), 1e-15);
    // A direction of the tool is turned as the tool is.
    const Vec3 along = frame.pose.rotate(hand.rotate({0, 0, 1}));
    ASSERT_LT(distance(a.rotate({0, 0, 1}), along), 1e-14);
  }
}

// A spring that pulls a point of the tool, and a hand that comes back to where it was by moves and turns.
TEST(DeviceFrame, ClosedMotionGivesTheHandTheWorkOfTheScene) {
  constexpr double kStiffness = 200;            // N/m
  const Vec3 lever{0.03, -0.01, 0.05}, home{};  // m, of the tool, and in the scene
  const DeviceFrame frame{turned(0.7, unit(Vec3{1, -2, 1}, {}), {0.1, 0, -0.2}), 3, 3};
  constexpr int kSteps = 20000;
  const auto hand = [](int step) {
    const double phase = 2 * kPi * step / kSteps;
    return turned(0.5 * std::sin(phase), unit(Vec3{1, 1, 3}, {}),
                  {0.01 * std::cos(phase), 0.004, 0.02 * std::sin(phase)});
  };
  double scene = 0, felt = 0, old = 0, gross = 0;
  for (int step = 0; step < kSteps; ++step) {
    const Pose now = hand(step), next = hand(step + 1), tool = frame.to_scene(now), moved = frame.to_scene(next);
    const Vec3 arm = tool.rotate(lever), force = -kStiffness * (tool.translation + arm - home);
    const Vec3 torque = cross(arm, force), way = moved.translation - tool.translation;
    const Vec3 hand_way = next.translation - now.translation, hand_turn = small_rotation(next * inverse(now));
    const double work = dot(force, way) + dot(torque, small_rotation(moved * inverse(tool)));
    scene += work;
    gross += std::fabs(work);
    felt += dot(frame.to_device(force), hand_way) + dot(frame.torque_to_device(torque), hand_turn);
    old += dot(frame.to_device(force), hand_way) + dot(frame.to_device(torque), hand_turn);
  }
  EXPECT_NEAR(felt, scene, 1e-12 * gross);
  EXPECT_LT(std::fabs(scene), 1e-3 * gross);  // a spring's
  EXPECT_GT(std::fabs(old), 0.05 * gross);    // with torques as forces are scaled it would be a motor
}

TEST(DeviceFrame, WrongMemberIsNamedAndGivesZeroForce) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  const Pose place = turned(0.7, unit(Vec3{1, -2, 1}, {}), {0.1, 0, -0.2});
  Pose none = place, far = place;
  none.rotation[4] += 0.1;
  far.translation.x = kNan;
  const std::pair<DeviceFrame, const char*> wrong[] = {
      {{none, 1, 1}, "no pose"},        {{far, 1, 1}, "no pose"},           {{place, 0, 1}, "motion scale"},
      {{place, -1, 1}, "motion scale"}, {{place, kNan, 1}, "motion scale"}, {{place, kInf, 1}, "motion scale"},
      {{place, 1, -1}, "force scale"},  {{place, 1, kNan}, "force"},        {{place, 1, kInf}, "force"}};
  for (const auto& [frame, what] : wrong) {
    ASSERT_NE(frame.validate(), nullptr) << what;
    EXPECT_NE(std::strstr(frame.validate(), what), nullptr) << frame.validate();
    EXPECT_EQ(length(frame.to_device({1, 2, 3})) + length(frame.torque_to_device({1, 2, 3})), 0) << what;
  }
  EXPECT_EQ((DeviceFrame{place, 3, 2}).validate(), nullptr);
  EXPECT_EQ(DeviceFrame().validate(), nullptr);
  EXPECT_EQ((DeviceFrame{place, 3, 0}).validate(), nullptr) << "a hand may only look on";
  EXPECT_NEAR(length((DeviceFrame{place, 3, 2}).to_device({1, 2, 2})), 6, 1e-12);
}

}  // namespace
}  // namespace palpate
