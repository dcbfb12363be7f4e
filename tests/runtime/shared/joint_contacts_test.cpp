// SPDX-License-Identifier: GPL-3.0-or-later
// Tools that feel each other's dents: against the root of their equations, round closed motions, and at extremes.
#include "palpate/shared/joint_contacts.hpp"

#include "formats/io/error.hpp"
#include "palpate/shared/tool_set.hpp"
#include "tests/runtime/support.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

namespace palpate::joint_test {
namespace {

using namespace test;
using runtime::Compliance;
using runtime::Matrix3;
using runtime::ToolSet;

// A flat box of one response; without modes the compliance is the half-space in closed form.
ResponseFileContent box(bool friction, int modes = 0, double stiffening = 0) {
  Options options = flat(friction);
  options.modes = modes;
  options.stiffening = stiffening;
  return box_content(options);
}

// m/N along the normal between two points of the box's top.
double half_space(double apart) {
  const double rho = std::sqrt(apart * apart + 1e-6);
  return (1 - 0.49) / (2 * M_PI * kSampleShear * rho);
}

// Force of each of two equal tips at a depth, by bisection of h(depth) - h(d) = C F(d) / h'(d), h(z) = z + bend z^2
// / 2.
double together(double depth, double compliance, double bend = 0) {
  const auto h = [&](double z) { return z + 0.5 * bend * z * z; };
  double low = 0, high = depth;
  for (int k = 0; k < 60; ++k) {
    const double d = 0.5 * (low + high);
    (h(depth) - h(d) > compliance * hertz(d) / (1 + bend * d) ? low : high) = d;
  }
  return hertz(low) * (1 + bend * depth) / (1 + bend * low);
}

template <class Tools>
auto press(Tools& tools, double depth, double apart, int ticks = 400) {
  decltype(tools.tick({})) last;
  for (int k = 0; k <= ticks; ++k) {
    const double now = -0.001 + (depth + 0.001) * k / ticks;
    last = tools.tick({upright(centre(now, -0.5 * apart)), upright(centre(now, 0.5 * apart))});
  }
  return last;
}

TEST(Compliance, IsTheTransposeTheOtherWayRound) {
  const Opened file(box(false, 16));
  const Compliance compliance(file.view);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> draw(0, 1);
  for (int k = 0; k < 50; ++k) {
    const auto point = [&] {
      const double a = draw(random), b = (1 - a) * draw(random);
      return runtime::BodyPoint{static_cast<std::uint32_t>(random() % file.view.meta->triangle_count),
                                {a, b, 1 - a - b}};
    };
    const runtime::BodyPoint a = point(), b = point();
    const Matrix3 there = compliance.between(a, b), back = runtime::transposed(compliance.between(b, a));
    for (int i = 0; i < 3; ++i) EXPECT_LT(length(there.row[i] - back.row[i]), 1e-12);
  }
}

// Over one triangle the modes are linear, so their tilt is a difference of displacements.
TEST(Compliance, TiltIsTheGradientOfTheModes) {
  const Opened file(box(false, 16));
  const Compliance compliance(file.view);
  const runtime::BodyPoint loaded{0, {0.2, 0.3, 0.5}};
  runtime::CompliancePoint from, at, there;
  runtime::ComplianceTilt by, tilt;
  compliance.locate(loaded, from, &by);
  const auto normal = [](const runtime::CompliancePoint& point) {
    return Vec3{point.place.normal[0], point.place.normal[1], point.place.normal[2]};
  };
  const auto by_modes = [&](const runtime::CompliancePoint& to) {
    return compliance.between(from, to) * normal(from) - compliance.of_half_space(from, to) * normal(from);
  };
  double largest = 0;
  for (std::uint32_t triangle = 0; triangle < file.view.meta->triangle_count; ++triangle) {
    const runtime::BodyPoint a{triangle, {0.6, 0.3, 0.1}}, b{triangle, {0.1, 0.2, 0.7}};
    compliance.locate(a, at, &tilt);
    compliance.locate(b, there);
    const double difference = dot(normal(at), by_modes(there) - by_modes(at));
    const double expected = dot(compliance.tilt(by, tilt), position(file.view, b) - position(file.view, a));
    largest = std::max(largest, std::fabs(difference));
    EXPECT_NEAR(difference, expected, 1e-9 * length(by_modes(at)) + 1e-12) << triangle;
  }
  EXPECT_GT(largest, 1e-6) << "the modes do not tilt anything";
}

TEST(JointContacts, TwoTipsHaveTheForceOfTheirEquation) {
  const Opened file(box(false));
  for (const double depth : {0.0005, 0.002, 0.004}) {
    for (const double radii : {1.0, 1.5, 2.0, 4.0}) {
      const double apart = radii * std::sqrt(kTipRadius * depth);
      ToolSet<2> tools(file.view, {0, 0});
      const auto last = press(tools, depth, apart);
      const double expected = together(depth, half_space(apart));
      EXPECT_TRUE(tools.joint()->balanced());
      EXPECT_EQ(tools.joint()->share(), 1);
      for (const Tick& tick : last) EXPECT_NEAR(tick.force.z, expected, 3e-3 * expected) << depth << ' ' << radii;
      EXPECT_LT(last[0].force.z, 0.97 * hertz(depth));
    }
  }
}

// Two tips that pinch the box move it between them and begin in one tick. Each lifts the surface towards the other:
// d = depth + C F(d).
TEST(JointContacts, TwoTipsThatBeginAtOncePushTheBodyAgainstEachOther) {
  constexpr double kDepth = 0.002, kBetween = kDepth / 10;  // m, and C F(depth)
  const double compliance = kBetween / hertz(kDepth);
  ResponseFileContent content = box(false, 8);
  content.compliance->negative = 0;
  std::fill(content.compliance->values.begin(), content.compliance->values.end(), 0.0);
  for (std::size_t site = 0; site < content.sites.size(); ++site) {
    content.compliance->values[24 * site + 2] = std::sqrt(compliance);  // along z alone
  }
  const Opened file(content);
  ToolSet<2> tools(file.view, {0, 0});
  std::array<Tick, 2> last;
  for (int k = 0; k <= 400; ++k) {
    const Vec3 above = centre(-0.001 + (kDepth + 0.001) * k / 400);
    last = tools.tick({upright(above), Pose{{1, 0, 0, 0, -1, 0, 0, 0, -1}, -above}});
    EXPECT_EQ(last[0].touches(), last[1].touches()) << k;
  }
  double lifted = kDepth;
  for (int k = 0; k < 50; ++k) lifted = kDepth + compliance * hertz(lifted);
  EXPECT_GT(hertz(lifted), 1.15 * hertz(kDepth));
  EXPECT_TRUE(tools.joint()->balanced());
  EXPECT_NEAR(last[0].force.z, hertz(lifted), 3e-3 * hertz(lifted));
  EXPECT_NEAR(last[1].force.z, -hertz(lifted), 3e-3 * hertz(lifted));
}

// Tissue that stiffens with the depth: tools lose less to each other.
TEST(JointContacts, StiffeningLeavesMoreOfTheForceOfTheirEquation) {
  constexpr double kDepth = 0.004, kStiffening = 0.4;
  const Opened file(box(false, 0, kStiffening));
  const double bend = kStiffening / file.view.meta->depth_scale;
  for (const double radii : {1.0, 2.0, 4.0}) {
    const double apart = radii * std::sqrt(kTipRadius * kDepth);
    ToolSet<2> tools(file.view, {0, 0});
    const auto last = press(tools, kDepth, apart);
    const double expected = together(kDepth, half_space(apart), bend);
    EXPECT_TRUE(tools.joint()->balanced());
    for (const Tick& tick : last) EXPECT_NEAR(tick.force.z, expected, 3e-3 * expected) << radii;
    EXPECT_GT(expected, 1.02 * together(kDepth, half_space(apart)));
  }
}

TEST(JointContacts, AFileHasAStiffeningFromZeroToOne) {
  for (const double stiffening : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(encode(box(false, 0, stiffening)), Error) << stiffening;
  }
}

TEST(JointContacts, TwoLooksSufficeNearlyAlways) {
  const Opened file(box(true, 32));
  ToolSet<5> tools(file.view, {0, 0, 0, 0, 0});
  int looks = 0, ticks = 0, most = 0;
  for (double t = 0; t < 6; t += 1e-3) {
    std::array<Pose, 5> poses;
    for (int k = 0; k < 5; ++k) {
      poses[static_cast<std::size_t>(k)] = upright(centre(
          0.0015 + 0.001 * std::sin(3 * t + k), 0.006 * (k - 2) + 0.001 * std::sin(t), 0.002 * std::cos(2 * t + k)));
    }
    tools.tick(poses);
    looks += tools.joint()->looks(), ++ticks;
    most = std::max(most, tools.joint()->looks());
  }
  EXPECT_LT(looks, 2.2 * ticks);
  EXPECT_LE(most, runtime::JointConstants::kLooks);
}

TEST(JointContacts, ForceMovesWithTheBody) {
  const Opened file(box(false, 8));
  ToolSet<2> still(file.view, {0, 0}), moving(file.view, {0, 0});
  const Pose world = turned(0.7, {0.6, 0, 0.8}, {0.1, -0.2, 0.3});
  for (int k = 0; k <= 200; ++k) {
    const double depth = -0.001 + 2e-5 * k;
    const std::array<Pose, 2> poses{upright(centre(depth, -0.002)), upright(centre(depth, 0.002))};
    const auto a = still.tick(poses);
    const auto b = moving.tick({world * poses[0], world * poses[1]}, runtime::RigidMotion{&file.view, world});
    for (std::size_t i = 0; i < 2; ++i) EXPECT_LT(length(world.rotate(a[i].force) - b[i].force), 1e-6);
  }
}

// J that the hands got back in a motion, and what went through it.
struct Work {
  double out = 0, through = 0;
  void add(const Vec3& before, const Vec3& after, const Vec3& way) {
    const double work = 0.5 * dot(before + after, way);
    out += work;
    through += std::fabs(work);
  }
};

// Closed random motions of 3000 ticks of several tips near each other, all away from the body at the end.
template <int Count>
Work work_of_motions(const runtime::View& view, std::uint32_t seed, int motions) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> draw(-1, 1);
  Work all;
  for (int motion = 0; motion < motions; ++motion) {
    std::array<std::uint32_t, Count> tool_indices{};
    ToolSet<Count> tools(view, tool_indices);
    std::array<Vec3, Count> from, amplitude, phase, at{}, force{};
    for (int k = 0; k < Count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      from[i] = {0.005 * (k - 0.5 * Count) + 0.001 * draw(random), 0.002 * draw(random), 0};
      amplitude[i] = {0.004 * draw(random), 0.004 * draw(random), 0.002 * draw(random)};
      phase[i] = {3 * draw(random), 3 * draw(random), 3 * draw(random)};
    }
    constexpr int kTicks = 3000;
    for (int tick = 0; tick <= kTicks; ++tick) {
      const double share = static_cast<double>(tick) / kTicks, in = std::sin(M_PI * share);
      std::array<Pose, Count> poses;
      for (std::size_t i = 0; i < Count; ++i) {
        const Vec3 w{from[i].x + amplitude[i].x * std::sin(12 * share + phase[i].x),
                     from[i].y + amplitude[i].y * std::sin(9 * share + phase[i].y),
                     0.0025 * in - 0.001 + amplitude[i].z * in * std::sin(40 * share + phase[i].z)};
        poses[i] = upright(centre(w.z, w.x, w.y));
      }
      const auto ticks = tools.tick(poses);
      for (std::size_t i = 0; i < Count; ++i) {
        if (tick > 0) all.add(force[i], ticks[i].force, poses[i].translation - at[i]);
        at[i] = poses[i].translation;
        force[i] = ticks[i].force;
        EXPECT_TRUE(finite(ticks[i].force));
      }
    }
  }
  return all;
}

template <int Count>
void expect_passive(const runtime::View& view, std::uint32_t seed, double bound) {
  const Work all = work_of_motions<Count>(view, seed, 12);
  EXPECT_LT(all.out, bound * all.through) << all.through;
}

TEST(JointContacts, ClosedMotionsGiveNothingBackWithoutFriction) {
  for (const double stiffening : {0.0, 0.5}) {
    const Opened file(box(false, 16, stiffening));
    expect_passive<2>(file.view, 1, 1e-3);
    expect_passive<4>(file.view, 2, 1e-3);
  }
}

TEST(JointContacts, ClosedMotionsGiveNothingBackWithFriction) {
  for (const double stiffening : {0.0, 0.5}) {
    const Opened file(box(true, 16, stiffening));
    expect_passive<2>(file.view, 3, 1e-3);
    expect_passive<4>(file.view, 4, 1e-3);
  }
}

// Tips pass through one another here: those nearer than a third of a contact radius jump.
TEST(LongJointContacts, TenMillionTicksOfTwoToFiveTipsGiveNothingBack) {
  constexpr int kMotions = 420;
  for (const double stiffening : {0.0, 0.5})
    for (const bool friction : {false, true}) {
      const Opened file(box(friction, 16, stiffening));
      const Work each[] = {work_of_motions<2>(file.view, 5, kMotions), work_of_motions<3>(file.view, 6, kMotions),
                           work_of_motions<4>(file.view, 7, kMotions), work_of_motions<5>(file.view, 8, kMotions)};
      Work all;
      for (int k = 0; k < 4; ++k) {
        std::printf("%d tips%s, stiffening %.1f: %.2g of the work that went through\n", k + 2,
                    friction ? ", friction" : "", stiffening, each[k].out / each[k].through);
        all.out += each[k].out;
        all.through += each[k].through;
      }
      EXPECT_LT(all.out, 1e-3 * all.through) << friction << ' ' << stiffening;
    }
}

// Pressed apart, drawn together, lifted, and the other way round: the coupling changes while the tips slide.
TEST(JointContacts, NeitherWayRoundALoopGivesEnergy) {
  for (const double stiffening : {0.0, 0.5})
    for (const bool near_first : {false, true}) {
      const Opened file(box(false, 0, stiffening));
      ToolSet<2> tools(file.view, {0, 0});
      Work work;
      std::array<Vec3, 2> at{}, force{};
      bool first = true;
      const auto go = [&](double depth, double apart) {
        const std::array<Pose, 2> poses{upright(centre(depth, -0.5 * apart)), upright(centre(depth, 0.5 * apart))};
        const auto ticks = tools.tick(poses);
        for (std::size_t i = 0; i < 2; ++i) {
          if (!first) work.add(force[i], ticks[i].force, poses[i].translation - at[i]);
          at[i] = poses[i].translation;
          force[i] = ticks[i].force;
        }
        first = false;
      };
      const double near = 0.004, far = 0.02, begin = near_first ? near : far, end = near_first ? far : near;
      for (int k = 0; k <= 1000; ++k) go(-0.0005 + 0.0025 * k / 1000, begin);
      for (int k = 0; k <= 2000; ++k) go(0.002, begin + (end - begin) * k / 2000);
      for (int k = 0; k <= 1000; ++k) go(0.002 - 0.0025 * k / 1000, end);
      EXPECT_LT(work.out, 1e-3 * work.through) << near_first << ' ' << stiffening;
      EXPECT_GT(work.out, -0.03 * work.through) << "the drag gives back what it took";
    }
}

TEST(JointContacts, TwoTipsAtOnePlaceAreFiniteAndSayThatTheShareIsCut) {
  const Opened file(box(false));
  ToolSet<2> tools(file.view, {0, 0});
  const auto last = press(tools, 0.004, 0);
  EXPECT_LT(tools.joint()->share(), 1);
  for (const Tick& tick : last) {
    EXPECT_TRUE(finite(tick.force));
    EXPECT_GE(tick.force.z, 0);
    EXPECT_LE(tick.force.z, 1.01 * hertz(0.004));
  }
}

TEST(JointContacts, StiffAndSoftBodiesAreFinite) {
  for (const double shear : {1e-3, 1.0, 1e6, 1e12}) {
    for (const bool friction : {false, true}) {
      ResponseFileContent content = box(friction);
      std::fill(content.compliance->shear.begin(), content.compliance->shear.end(), shear);
      const Opened file(std::move(content));
      ToolSet<2> tools(file.view, {0, 0});
      const auto last = press(tools, 0.004, 0.004);
      for (const Tick& tick : last) {
        EXPECT_TRUE(finite(tick.force)) << shear;
        EXPECT_LE(length(tick.force), 1.5 * hertz(0.004)) << shear;
      }
      if (shear > 1e9) {
        EXPECT_NEAR(last[0].force.z, hertz(0.004), 1e-2 * hertz(0.004));
      }
    }
  }
}

TEST(JointContacts, AToolAloneHasItsOwnForce) {
  const Opened file(box(true, 8));
  ToolSet<2> tools(file.view, {0, 0});
  runtime::Contact alone(file.view, 0);
  for (double t = 0; t < 3; t += 1e-3) {
    const Tick one = alone.tick(probing(t));
    const auto both = tools.tick({probing(t), upright({0, 0, 1})});
    EXPECT_LT(length(one.force - both[0].force), 1e-12);
    EXPECT_EQ(length(both[1].force), 0);
  }
}

// The forces of the others are those without the tool whose tracker is lost.
TEST(JointContacts, AFaultOfOneToolIsItsOwnAlone) {
  for (const bool friction : {false, true}) {
    const Opened file(box(friction));
    ToolSet<3> tools(file.view, {0, 0, 0}), without(file.view, {0, 0, 0});
    for (int k = 0; k <= 440; ++k) {
      const double z = std::min(0.002, -0.001 + 0.003 * k / 400);
      std::array poses{upright(centre(z, -0.0025)), upright(centre(z, 0.0025)), upright(centre(-0.1, 0))};
      const auto right = without.tick(poses);
      const bool lost = k > 300 && k % 4 != 0;
      if (lost) poses[2].translation.x = std::numeric_limits<double>::quiet_NaN();
      const auto ticks = tools.tick(poses);
      EXPECT_EQ(ticks[2].state, lost ? State::fault : State::free);
      for (int tool : {0, 1}) EXPECT_EQ(length(ticks[tool].force - right[tool].force), 0);
    }
  }
}

// The other tool does not feel the dent of a pressed tool whose tracker is lost.
TEST(JointContacts, TheOtherToolIsAloneAfterAFault) {
  const Opened file(box(false));
  ToolSet<2> tools(file.view, {0, 0});
  press(tools, 0.002, 0.005);
  Pose bad = upright(centre(0.002));
  bad.translation.x = std::numeric_limits<double>::quiet_NaN();
  const Pose other = upright(centre(0.002, 0.0025));
  const auto ticks = tools.tick({bad, other});
  EXPECT_EQ(ticks[0].state, State::fault);
  EXPECT_EQ(length(ticks[0].force), 0);
  for (int k = 0; k < 5; ++k) {
    const double force = length(tools.tick({bad, other})[1].force);
    EXPECT_LE(force, 1.001 * hertz(0.002));
    EXPECT_GT(force, 0.5 * hertz(0.002));
  }
}

TEST(JointContacts, AFaultOfTheBodyForgetsAll) {
  const Opened file(box(false));
  ToolSet<2> tools(file.view, {0, 0});
  press(tools, 0.002, 0.005);
  Pose bad;
  bad.translation.x = std::numeric_limits<double>::quiet_NaN();
  const std::array poses{upright(centre(0.002, -0.0025)), upright(centre(0.002, 0.0025))};
  for (const Tick& tick : tools.tick(poses, runtime::RigidMotion{&file.view, bad})) EXPECT_EQ(tick.state, State::fault);
  for (const Tick& tick : tools.tick(poses)) EXPECT_TRUE(finite(tick.force));
}

}  // namespace
}  // namespace palpate::joint_test
