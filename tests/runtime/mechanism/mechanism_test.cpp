// SPDX-License-Identifier: GPL-3.0-or-later
// Mechanisms against laws of statics: levers, springs in series, Hertz' contact of two bodies.
#include "palpate/mechanism/mechanism.hpp"

#include "tests/runtime/allocation_counter.hpp"
#include "tests/runtime/support.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace palpate::mechanism_test {
namespace {

using namespace test;
using namespace runtime;

constexpr double kFreeRotation = 1e-3;  // N m/rad: a device without torque
constexpr double kFixedRotation = 1e6;

HandleSpring handle(double stiffness, double rotation, const Vec3& grip = {}) { return {stiffness, rotation, grip}; }

Pose shaft() { return {}; }  // along the tool's z axis

// A box of one response with the compliance of a half-space.
ResponseFileContent box(bool friction, double rounding = 1e-3) {
  Options options = flat(friction);
  options.modes = 0;
  ResponseFileContent content = box_content(options);
  content.compliance->rounding = rounding;
  return content;
}

CompliancePoint place(const Vec3& at, const Vec3& normal, double shear) {
  CompliancePoint point{};
  point.place = {{at.x, at.y, at.z}, {normal.x, normal.y, normal.z}, shear};
  return point;
}

// A tip at the origin of the tool, a trocar 0.1 m and a grip 0.3 m along its shaft: levers of 0.2 and 0.1 m.
TEST(Trocar, HandleHasTheForceOfTheLever) {
  for (const double tip_force : {0.1, 1.0, 5.0}) {
    Mechanism<1, 8> tool({handle(2000, kFreeRotation, {0, 0, 0.3})});
    ASSERT_EQ(tool.add(trocar(0, shaft(), Side::ground({0, 0, 0.1}))), 0);
    // A constant force on the tip: a friction row against ground that is far away.
    Constraint push;
    push.a = Side::tool(0, {0, 0, 0});
    push.b = Side::ground({10, 0, 0});
    push.direction[0] = {1, 0, 0};
    push.kind[0] = RowKind::friction;
    push.limit = tip_force;
    push.begun = true;
    ASSERT_EQ(tool.add(push), 1);
    HandleForce last;
    for (int k = 0; k < 50; ++k) last = tool.tick({Pose{}})[0];
    ASSERT_EQ(tool.outcome().cause, nullptr);
    const double levers = 0.1 / 0.2;  // of the undeformed tool; a spring of 2000 N/m turns it by less than 1 degree
    EXPECT_NEAR(std::fabs(last.force.x), levers * tip_force, 1e-3 * levers * tip_force);
    EXPECT_LT(length(last.torque), 1e-3 * tip_force * 0.1);
    EXPECT_LT(last.force.x * tool.constraint(1).force[0], 0) << "the lever turns the force round";
  }
}

TEST(Trocar, ContactAtTheTipIsFeltThroughTheLever) {
  const Opened file(box(true));
  const CompliantBody body(file.view);
  Mechanism<1, 8> tool({handle(300, kFreeRotation, {0, 0, 0.3})});
  ASSERT_EQ(tool.add(trocar(0, shaft(), Side::ground({0, 0, kTop + kTipRadius + 0.1}))), 0);
  std::array<Contact, 1> contacts{Contact(file.view, 0)};
  HandleForce last;
  int looks = 0;
  for (int k = 0; k <= 600; ++k) {  // down, then aside
    const double down = std::min(k, 300) / 300.0, aside = std::max(0, k - 300) / 300.0;
    last = tool.tick({upright(centre(0.004 * down - 0.001, 0.003 * aside))}, contacts, body)[0];
    ASSERT_TRUE(tool.outcome().balanced) << k;
    looks += tool.outcome().looks;
  }
  EXPECT_LT(looks, 3 * 600);
  const Vec3 tip = last.contact.force;
  const double levers = length(last.tool.apply({0, 0, 0.1}) - last.tool.apply({})) / 0.2;
  EXPECT_GT(std::fabs(tip.x), 0.05);
  EXPECT_LT(std::fabs(dot(last.force - tip, last.tool.axis())), 2e-3 * tip.z) << "nothing holds the shaft along it";
  // Moments about the trocar, with the skin point as the end of the lever.
  const Vec3 pivot{0, 0, kTop + kTipRadius + 0.1}, grip = last.tool.apply({0, 0, 0.3});
  const Vec3 at = last.tool.apply(contacts[0].state().applied.point);
  const Vec3 moment = cross(at - pivot, tip) - cross(grip - pivot, last.force) - last.torque;
  EXPECT_LT(length(moment), 2e-3 * length(tip) * 0.1);
  EXPECT_NEAR(std::fabs(last.force.x), levers * std::fabs(tip.x), 0.1 * std::fabs(tip.x));
}

TEST(Trocar, WallIsASpringInSeries) {
  const Opened file(box(false));
  const CompliantBody wall(file.view);
  const CompliancePoint incision = place({0, 0, kTop}, {0, 0, 1}, kSampleShear);
  const double radius = 0.004, aside = 2e-3;
  Mechanism<1, 8> tool({handle(400, kFixedRotation)});
  ASSERT_EQ(tool.add(trocar(0, shaft(), Side::surface(wall, incision, radius))), 0);
  const HandleForce force = tool.tick({upright({aside, 0, 0.1})})[0];
  // Mean displacement of a disc under a tangential load (Johnson 1985, chapter 3).
  const double nu = 0.49, compliance = (2 - nu) / (4 * M_PI * kSampleShear) * 16 / (3 * M_PI * radius);
  const double expected = aside / (1 / 400.0 + compliance);
  EXPECT_NEAR(-force.force.x, expected, 5e-3 * expected);
}

TEST(Trocar, FrictionDissipatesItsBoundTimesTheWay) {
  const double bound = 0.4;
  Mechanism<1, 8> tool({handle(1000, kFixedRotation)});
  ASSERT_EQ(tool.add(trocar(0, shaft(), Side::ground({0, 0, 0}), bound)), 0);
  double work = 0, before = 0, last = 0;
  const auto go = [&](double z) {
    const double force = tool.tick({upright({0, 0, z})})[0].force.z;
    work -= 0.5 * (force + before) * (z - last);
    before = force;
    last = z;
  };
  const double stretch = bound / 1000, amplitude = 0.02;
  for (int k = 0; k <= 4000; ++k) go(amplitude * std::sin(2 * M_PI * k / 1000.0));
  // Four strokes of the device to each side, less what the spring takes at each turn.
  const double way = 4 * 4 * amplitude - 8 * 2 * stretch + stretch;
  EXPECT_NEAR(work, bound * way, 2e-3 * bound * way);
}

TEST(Weld, TwoSpringsHoldOneTool) {
  Mechanism<2, 8> tools({handle(300, 0.5), handle(900, 1.5)});
  tools.tick({Pose{}, Pose{}});
  ASSERT_TRUE(tools.add(weld(0, Pose{}, 1, Pose{})));
  const auto forces = tools.tick({upright({0, 0, 0}), upright({1e-3, 0, 0})});
  const double expected = 1e-3 / (1 / 300.0 + 1 / 900.0);
  EXPECT_NEAR(forces[0].force.x, expected, 1e-6 * expected);
  EXPECT_NEAR(forces[1].force.x, -expected, 1e-6 * expected);
  EXPECT_LT(length(forces[0].tool.translation - forces[1].tool.translation), 1e-12);
  // A turn of one device is shared by the two springs.
  std::array<HandleForce, 2> turned;
  for (int k = 0; k < 10; ++k) turned = tools.tick({Pose{}, test::turned(0.1, {0, 1, 0}, {})});
  const double torque = 0.1 / (1 / 0.5 + 1 / 1.5);
  EXPECT_NEAR(turned[0].torque.y, torque, 1e-6 * torque);
  EXPECT_NEAR(turned[1].torque.y, -torque, 1e-6 * torque);
}

TEST(Hinge, TurnsAboutItsAxisAlone) {
  Mechanism<2, 8> jaws({handle(500, 1), handle(500, 1)});
  ASSERT_TRUE(jaws.add(hinge(0, Pose{}, 1, Pose{})));
  std::array<HandleForce, 2> forces;
  const auto turn = [&](const Vec3& axis) {
    for (int k = 0; k < 20; ++k) forces = jaws.tick({Pose{}, turned(0.4, axis, {})});
  };
  turn({0, 0, 1});
  EXPECT_LT(length(forces[0].torque), 1e-9);
  EXPECT_LT(length(forces[1].force), 1e-9);
  turn({1, 0, 0});
  EXPECT_NEAR(forces[0].torque.x, 0.2, 1e-3);
  EXPECT_NEAR(forces[1].torque.x, -0.2, 1e-3);
}

TEST(Suture, KnotHasTheComplianceOfItsTwoPlaces) {
  const Opened file(box(false));
  const CompliantBody body(file.view);
  const CompliancePoint a = place({-0.005, 0, kTop}, {0, 0, 1}, kSampleShear),
                        b = place({0.005, 0, kTop}, {0, 0, 1}, kSampleShear);
  const double radius = 0.002;
  Mechanism<1, 8> thread({handle(500, 1)});
  ASSERT_EQ(thread.add(suture(Side::surface(body, a, radius), Side::surface(body, b, radius))), 0);
  thread.tick({Pose{}});
  const Vec3 x{1, 0, 0};
  const double own = dot(x, body.compliance.within(a, radius) * x), between = dot(x, body.compliance.between(a, b) * x);
  EXPECT_NEAR(thread.constraint(0).force[0], 0.01 / (2 * own - 2 * between), 1e-9);
  // Pulled upwards by a tool, half of the force on each place.
  ASSERT_EQ(thread.add(suture(Side::tool(0, {}), Side::surface(body, a, radius), 0.02)), 1);
  EXPECT_EQ(thread.tick({upright({0, 0, kTop + 0.01})})[0].force.z, 0);
  const HandleForce pulled = thread.tick({upright({-0.005, 0, kTop + 0.025})})[0];
  EXPECT_LT(pulled.force.z, -0.1);
}

// Two balls of 30 mm whose surfaces are half-spaces of different moduli, with facing places 0.2 mm apart.
TEST(Touching, TwoBallsInAColumnAreHertzContact) {
  constexpr double kPitch = 0.2e-3, kNu = 0.49, kShear[2] = {4e3, 11e3}, kHalf = 0.5 * kBallRadius;
  const Opened file(box(false, 1e-6));
  const CompliantBody upper(file.view), lower(file.view);
  std::vector<CompliancePoint> places;
  std::vector<double> distances;
  for (int i = -7; i <= 7; ++i) {
    for (int j = -7; j <= 7; ++j) {
      if (i * i + j * j > 49) continue;
      const double x = kPitch * i, y = kPitch * j;
      places.push_back(place({x, y, 0}, {0, 0, -1}, kShear[0]));
      places.push_back(place({x, y, 0}, {0, 0, 1}, kShear[1]));
      distances.push_back((x * x + y * y) / (2 * kHalf));
    }
  }
  const auto column = [&](double depth) {
    MechanismOptions options;
    options.sweeps = 64;
    const auto balls = std::make_unique<Mechanism<1, 149>>(std::array<HandleSpring, 1>{handle(500, 1)}, options);
    for (std::size_t k = 0; k < distances.size(); ++k) {
      const double radius = kPitch / std::sqrt(M_PI);
      Constraint c = touching(Side::surface(upper, places[2 * k], radius),
                              Side::surface(lower, places[2 * k + 1], radius), {0, 0, 1});
      c.offset[0] = distances[k] - depth;
      c.begun = true;
      EXPECT_GE(balls->add(c), 0);
    }
    for (int k = 0; k < 5; ++k) balls->tick({Pose{}});
    EXPECT_TRUE(balls->outcome().rows.converged(1e-3));
    double force = 0;
    for (int k = 0; k < balls->count(); ++k) force += balls->constraint(k).force[0];
    return force;
  };
  EXPECT_EQ(column(-1e-9), 0);
  EXPECT_EQ(column(0), 0);
  const double modulus = 1 / ((1 - kNu) / (2 * kShear[0]) + (1 - kNu) / (2 * kShear[1]));
  for (const double depth : {8e-5, 9e-5, 1e-4}) {
    const double hertz = 4.0 / 3 * modulus * std::sqrt(kHalf) * depth * std::sqrt(depth);
    EXPECT_NEAR(column(depth), hertz, 0.03 * hertz) << depth;
  }
}

// A plate on a handle that presses 40 places of a box; the host adds and removes them at a low rate.
struct PressedPlate {
  const CompliantBody& body;
  std::vector<CompliancePoint> places;
  std::unique_ptr<Mechanism<1, 120>> plate;

  explicit PressedPlate(const CompliantBody& pressed)
      : body(pressed), plate(std::make_unique<Mechanism<1, 120>>(std::array<HandleSpring, 1>{handle(500, 0.5)})) {
    for (int k = 0; k < 40; ++k) {
      places.push_back(place({0.0035 * (k % 8 - 3.5), 0.0035 * (k / 8 - 2), kTop}, {0, 0, 1}, kSampleShear));
    }
  }
  /// Places within 5 mm of the plate, which keep their state; `pose`: of the device.
  void find(const Pose& pose) {
    std::vector<Constraint> kept;
    for (int k = 0; k < plate->count(); ++k) kept.push_back(plate->constraint(k));
    plate->clear();
    for (const CompliancePoint& at : places) {
      const Side surface = Side::surface(body, at, 0.0017);
      const Vec3 on_tool{surface.point.x, surface.point.y, 4 * (surface.point.x * surface.point.x)};
      if (pose.apply(on_tool).z - kTop > 0.005) continue;
      const auto old = std::find_if(kept.begin(), kept.end(), [&](const Constraint& c) { return c.b.place == &at; });
      EXPECT_GE(plate->add(old != kept.end() ? *old : touching(Side::tool(0, on_tool), surface, {0, 0, 1}, 0.3)), 0);
    }
  }
  Vec3 tick(const Pose& pose) { return plate->tick({pose})[0].force; }
};

// m: presses of up to 3 mm at 0.1 m/s, drawn 3 mm aside; lifted at the end.
Vec3 stroke(double t) {
  const double down = std::sin(4 * M_PI * t);
  return {3e-3 * std::sin(15 * t), 0, kTop + 5e-3 - 8e-3 * down * down};
}

// A row that is found late begins without force. Below 30 Hz rows are late at this speed.
TEST(Touching, RowsAddedAtALowRateAreStable) {
  const Opened file(box(true));
  const CompliantBody body(file.view);
  const auto run = [&](int period) {
    PressedPlate plate(body);
    std::vector<Vec3> forces;
    for (int k = 0; k <= 1000; ++k) {
      const Pose pose = upright(stroke(1e-3 * k));
      if (k % period == 0) plate.find(pose);
      forces.push_back(plate.tick(pose));
    }
    return forces;
  };
  const std::vector<Vec3> every = run(1);
  double peak = 0;
  for (const Vec3& f : every) peak = std::max(peak, length(f));
  EXPECT_GT(peak, 0.5);
  for (const int period : {16, 33, 100, 200}) {
    const std::vector<Vec3> late = run(period);
    double worst = 0, most = 0, work = 0, through = 0;
    for (std::size_t k = 0; k < late.size(); ++k) {
      worst = std::max(worst, length(late[k] - every[k]));
      most = std::max(most, length(late[k]));
      if (k == 0) continue;
      const double step = dot(0.5 * (late[k] + late[k - 1]), stroke(1e-3 * double(k)) - stroke(1e-3 * double(k - 1)));
      work += step;
      through += std::fabs(step);
    }
    RecordProperty("off_at_period_" + std::to_string(period), std::to_string(worst / peak));
    if (period <= 33) {
      EXPECT_LT(worst, 1e-3 * peak) << period;
    }
    EXPECT_LT(most, 1.1 * peak) << period;
    EXPECT_LT(work, 1e-3 * through) << period << ": the plate gives energy";
    EXPECT_EQ(length(late.back()), 0);
  }
}

TEST(Mechanism, OldCompliancesLeaveTheBalance) {
  HandleForce settled[2];
  for (int n = 0; n < 2; ++n) {
    MechanismOptions options;
    options.every = n == 0 ? 1 : 50;
    Mechanism<1, 8> tool({handle(500, 0.01, {0, 0, 0.3})}, options);
    tool.add(trocar(0, shaft(), Side::ground({0, 0, 0.1})));
    for (int k = 0; k <= 1400; ++k) settled[n] = tool.tick({upright({0.1 * std::min(k, 400) / 400, 0, 0})})[0];
  }
  EXPECT_LT(length(settled[0].force - settled[1].force), 1e-6 * length(settled[0].force));
  EXPECT_LT(length(settled[0].torque - settled[1].torque), 1e-6 * length(settled[0].torque));
}

TEST(Mechanism, ContactAloneIsThatOfASpringInSeries) {
  const Opened file(box(false));
  const CompliantBody body(file.view);
  Mechanism<1, 3> tool({handle(200, kFixedRotation)});
  std::array<Contact, 1> contacts{Contact(file.view, 0)};
  double felt = 0;
  for (int k = 0; k <= 300; ++k) felt = tool.tick({upright(centre(2e-5 * k - 1e-3))}, contacts, body)[0].force.z;
  double low = 0, high = 5e-3;  // depth of the device: F(z) = k (depth - z)
  for (int k = 0; k < 60; ++k) {
    const double z = 0.5 * (low + high);
    (hertz(z) < 200 * (5e-3 - z) ? low : high) = z;
  }
  EXPECT_NEAR(felt, hertz(low), 2e-3 * felt);
}

// A press of the box's top beside a knot on it: the tool's force moves the knot, and the knot's the tool.
TEST(Mechanism, ContactFeelsTheRowsOnItsBody) {
  const Opened file(box(false));
  const CompliantBody body(file.view);
  const CompliancePoint anchored = place({0.006, 0, kTop}, {0, 0, 1}, kSampleShear);
  const Side knot = Side::surface(body, anchored, 0.002);
  Mechanism<1, 6> tool({handle(1e5, kFixedRotation)});
  ASSERT_EQ(tool.add(suture(knot, Side::ground(knot.point + Vec3{0, 0, 1e-3}))), 0);  // drawn up by 1 mm
  std::array<Contact, 1> contacts{Contact(file.view, 0)};
  HandleForce last;
  for (int k = 0; k <= 300; ++k) {
    last = tool.tick({upright(centre(1e-5 * k - 1e-3))}, contacts, body)[0];
    ASSERT_TRUE(tool.outcome().balanced) << k;
  }
  const Constraint& row = tool.constraint(0);
  const Vec3 pull = row.force[0] * row.direction[0] + row.force[1] * row.direction[1] + row.force[2] * row.direction[2];
  const CompliancePoint under = body.locate(contacts[0].state().place.body_point.at);
  const Vec3 raised = body.displacement(anchored, under, pull);
  const double device = 2e-3 - last.force.z / 1e5;  // depth of the tool
  EXPECT_NEAR(last.contact.force.z, hertz(device + raised.z), 3e-3 * last.contact.force.z);
  EXPECT_GT(last.contact.force.z, 1.02 * hertz(device));
  const Vec3 moved =
      body.compliance.within(anchored, 0.002) * pull + body.displacement(under, anchored, -last.contact.force);
  EXPECT_LT(length(moved - Vec3{0, 0, 1e-3}), 1e-5);
}

// Random closed motions of a tool through a trocar that presses, slides and lifts. The hand's work counts rotations
// too.
TEST(Mechanism, ClosedMotionsGiveNothingBack) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> draw(-1, 1);
  for (const bool friction : {false, true}) {
    const Opened file(box(friction));
    const CompliantBody body(file.view);
    double out = 0, through = 0;
    int ticks = 0, unbalanced = 0;
    for (int motion = 0; motion < 20; ++motion) {
      Mechanism<1, 8> tool({handle(400, 0.2, {0, 0, 0.3})});
      tool.add(trocar(0, shaft(), Side::ground({0, 0, kTop + kTipRadius + 0.1}), friction ? 0.05 : 0));
      std::array<Contact, 1> contacts{Contact(file.view, 0)};
      const Vec3 amplitude{0.004 * draw(random), 0.004 * draw(random), 0.0015 * draw(random)};
      const Vec3 phase{3 * draw(random), 3 * draw(random), 3 * draw(random)};
      Vec3 force, torque;
      Pose at;
      constexpr int kTicks = 3000;
      for (int k = 0; k <= kTicks; ++k) {
        const double share = static_cast<double>(k) / kTicks, in = std::sin(M_PI * share);
        const Vec3 aside{amplitude.x * in * std::sin(25 * share + phase.x),
                         amplitude.y * in * std::sin(19 * share + phase.y), 0};
        const double depth = -0.001 + 0.003 * in + amplitude.z * in * std::sin(40 * share + phase.z);
        const Pose pose = turned(0.05 * in * std::sin(15 * share), {0, 1, 0}, centre(depth) + aside);
        const HandleForce felt = tool.tick({pose}, contacts, body)[0];
        ASSERT_TRUE(finite(felt.force) && finite(felt.torque));
        if (k > 0) {
          const Vec3 way = pose.apply({0, 0, 0.3}) - at.apply({0, 0, 0.3});
          const double work =
              0.5 * (dot(force + felt.force, way) + dot(torque + felt.torque, small_rotation(pose * inverse(at))));
          out += work;
          through += std::fabs(work);
        }
        force = felt.force;
        torque = felt.torque;
        at = pose;
        ++ticks;
        unbalanced += tool.outcome().balanced ? 0 : 1;
      }
    }
    EXPECT_LT(out, 1e-3 * through) << friction;
    EXPECT_LT(unbalanced, 1e-3 * ticks) << friction;
    RecordProperty(friction ? "friction" : "smooth", std::to_string(out / through));
  }
}

TEST(Mechanism, WrongValuesHaveNoForceAndACause) {
  Mechanism<1, 8> wrong({handle(-1, 1)});
  EXPECT_NE(wrong.validate(), nullptr);
  EXPECT_EQ(length(wrong.tick({Pose{}})[0].force), 0);
  EXPECT_NE(wrong.outcome().cause, nullptr);
  Mechanism<1, 2> tool({handle(100, 1)});
  EXPECT_EQ(tool.add(trocar(0, shaft(), Side::ground({0, 0, 0.1}), 1)), -1) << "three rows in two";
  EXPECT_EQ(tool.add(trocar(1, shaft(), Side::ground({0, 0, 0.1}))), -1) << "no such handle";
  EXPECT_EQ(tool.add(trocar(0, shaft(), Side::ground({0, 0, 0.1}))), 0);
  EXPECT_GT(length(tool.tick({upright({0.01, 0, 0})})[0].force), 0.1);
  Pose bad;
  bad.translation.x = NAN;
  EXPECT_EQ(length(tool.tick({bad})[0].force), 0);
  EXPECT_NE(tool.outcome().cause, nullptr);
  EXPECT_GT(length(tool.tick({upright({0.01, 0, 0})})[0].force), 0.1) << "the next pose is good again";
}

TEST(Mechanism, WrongConstraintIsNamedAndNotAdded) {
  const Opened file(box(false));
  const CompliantBody body(file.view);
  const CompliancePoint at = place({0, 0, kTop}, {0, 0, 1}, kSampleShear);
  const Constraint good = touching(Side::tool(0, {}), Side::surface(body, at, 0.002), {0, 0, 1}, 0.3);
  ASSERT_EQ(good.validate(), nullptr);
  std::vector<Constraint> wrong;
  const auto change = [&](const auto& with) { with(wrong.emplace_back(good)); };
  change([](Constraint& c) { c.limit = -0.5; });
  change([](Constraint& c) { c.limit = NAN; });
  change([](Constraint& c) { c.direction[0].x = NAN; });
  change([](Constraint& c) { c.direction[0] = {0, 0, 1.1}; });
  change([](Constraint& c) { c.direction[2] = c.direction[1]; });
  change([](Constraint& c) { c.offset[1] = HUGE_VAL; });
  change([](Constraint& c) { c.force[2] = NAN; });
  change([](Constraint& c) { c.late = -1; });
  change([](Constraint& c) { c.a.point.y = NAN; });
  change([](Constraint& c) { c.b.radius = 0; });
  change([](Constraint& c) { c.b.place = nullptr; });
  change([](Constraint& c) { c.b.body = nullptr; });
  change([](Constraint& c) { c.kind[1] = RowKind::bilateral; });
  change([](Constraint& c) { std::swap(c.kind[0], c.kind[1]); });
  change([](Constraint& c) { c.frame = DirectionFrame::line; });
  wrong.push_back(suture(Side::ground({0, 0, 0}), Side::ground({1, 0, 0})));
  wrong.push_back(trocar(0, shaft(), Side::ground({}), -0.5));
  for (const Constraint& c : wrong) {
    Mechanism<1, 8> tool({handle(100, 1)});
    const auto which = &c - wrong.data();
    EXPECT_NE(c.validate(), nullptr) << which;
    EXPECT_EQ(tool.add(c), -1) << which;
    EXPECT_FALSE(tool.add(std::array<Constraint, 2>{good, c})) << which;
    EXPECT_EQ(tool.count(), 0) << which;
    for (int k = 0; k < 3; ++k) EXPECT_EQ(length(tool.tick({upright({0, 0, 0.1})})[0].force), 0) << which;
    EXPECT_EQ(tool.outcome().cause, nullptr) << which;
  }
}

TEST(Mechanism, JointWithoutRoomForAllRowsIsNotAdded) {
  Mechanism<2, 4> jaws({handle(500, 1), handle(500, 1)});
  EXPECT_FALSE(jaws.add(hinge(0, Pose{}, 1, Pose{}))) << "five rows in four";
  EXPECT_EQ(jaws.count(), 0);
  EXPECT_EQ(length(jaws.tick({Pose{}, upright({0.01, 0, 0})})[0].force), 0);
}

TEST(Mechanism, NoTickAllocates) {
  const Opened file(box(true));
  const CompliantBody body(file.view);
  Mechanism<1, 8> tool({handle(300, kFreeRotation, {0, 0, 0.3})});
  tool.add(trocar(0, shaft(), Side::ground({0, 0, kTop + 0.1}), 0.1));
  std::array<Contact, 1> contacts{Contact(file.view, 0)};
  const long before = allocations();
  for (int k = 0; k < 100; ++k) tool.tick({upright(centre(4e-5 * k - 1e-3))}, contacts, body);
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace palpate::mechanism_test
