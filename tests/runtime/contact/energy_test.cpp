// SPDX-License-Identifier: GPL-3.0-or-later
// The energy of a contact: E is what the hand put in, counted depth never exceeds that whose work E covers, the force comes back.
#include "palpate/contact/energy_tank.hpp"

#include <algorithm>
#include <cmath>

#include "tests/runtime/support.hpp"

namespace palpate::energy_test {
namespace {

using namespace test;
using runtime::Contact;
using runtime::EnergyConstants;
using runtime::EnergyMeter;
using runtime::EnergyTank;

/// A box whose stiffness grows along x: `factor(x)` times the sample's. Neither bias nor, by default, friction.
template <class Factor>
ResponseFileContent graded_box(const Factor& factor, bool friction = false) {
  Options options = flat(friction);
  options.cells = 12;
  ResponseFileContent content = box_content(options);
  for (std::size_t i = 0; i < content.sites.size(); ++i) {
    content.responses[i].unit *= static_cast<float>(factor(content.surface_vertices[i][0]));
  }
  return content;
}

TEST(Energy, PressStoresTheWorkOfTheHand) {
  const Opened box(box_content(flat()));
  Contact contact(box.view, 0);
  EnergyMeter meter;
  const auto see = [&](const Pose& pose, const Tick& tick) {
    meter.add(pose, tick);
    if (!tick.touches()) return;
    const double stored = contact.response().law().at(tick.depth).work;
    ASSERT_NEAR(contact.state().energy.energy(), stored, 1e-9 * stored);
    ASSERT_EQ(tick.counted_depth, tick.depth);
  };
  move(contact, centre(-0.001), centre(0.004), 1e-5, see);
  EXPECT_NEAR(meter.given(), contact.state().energy.energy(), 1e-3 * meter.given());
  move(contact, centre(0.004), centre(-0.001), 1e-5, see);
  EXPECT_NEAR(meter.returned(), meter.given(), 1e-3 * meter.given());
}

// Promise 10.
TEST(Energy, SlideOverAUniformBodyKeepsTheWholeDepth) {
  for (const bool friction : {false, true}) {
    const Opened box(box_content(flat(friction)));
    Contact contact(box.view, 0);
    move(contact, centre(-0.001, -0.01), centre(0.003, -0.01));
    move(contact, centre(0.003, -0.01), centre(0.003, 0.01), 1e-5, [&](const Pose&, const Tick& tick) {
      ASSERT_NEAR(tick.counted_depth, tick.depth, 1e-9);
      if (!friction) {
        ASSERT_NEAR(tick.force.z, contact.response().law().at(tick.depth).normal_force, 1e-9);
        ASSERT_LT(std::hypot(tick.force.x, tick.force.y), 1e-9);
      }
    });
  }
}

// From no contact to no contact through sticking and slipping. The sum over trapezoids errs by the square of the step.
TEST(Energy, ClosedMotionsGiveNoWork) {
  std::mt19937 random(41);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  for (int kind = 0; kind < 5; ++kind) {
    Options options = kind % 2 == 0 ? uniform() : Options();
    options.spring = kind == 2;
    options.softening = kind == 3;
    options.friction = kind != 4;
    const Opened box(box_content(options));
    Contact contact(box.view, 0);
    int slid = 0, stuck = 0;
    double worst = 0;
    for (int motion = 0; motion < 60; ++motion) {
      double work = 0, gross = 0;
      Vec3 at{0.003, 0.002, kTop + kTipRadius + 1e-5};
      Tick last = contact.tick(upright(at));
      const auto go = [&](const Vec3& to) {
        const int steps = 1 + static_cast<int>(length(to - at) / 2e-6);
        const Vec3 step = (1.0 / steps) * (to - at);
        for (int k = 0; k < steps; ++k) {
          at = at + step;
          const Tick tick = contact.tick(upright(at));
          const double w = -0.5 * dot(last.force + tick.force, step);
          work += w;
          gross += std::abs(w);
          slid += tick.state == State::slide;
          stuck += tick.state == State::stick;
          last = tick;
        }
      };
      const Vec3 start = at;
      for (int leg = 0; leg < 5; ++leg) {
        go({0.003 + draw(-0.5e-3, 0.5e-3), 0.002 + draw(-0.5e-3, 0.5e-3), kTop + kTipRadius - draw(0.1e-3, 2e-3)});
      }
      go({at.x, at.y, start.z});
      go(start);
      ASSERT_EQ(last.depth, 0);
      worst = std::min(worst, work / gross);
    }
    EXPECT_GT(worst, -2e-4) << kind;
    EXPECT_GT(slid, 1000) << kind;
    EXPECT_EQ(stuck > 1000, options.friction) << kind;
  }
}

TEST(Energy, LiftAtAHarderPlaceGivesBackAtMostWhatTheHandGave) {
  const Opened box(graded_box([](double x) { return 1 + (x + kBoxSize / 2) / kBoxSize; }));
  Contact contact(box.view, 0);
  EnergyMeter meter;
  const auto see = [&](const Pose& pose, const Tick& tick) {
    meter.add(pose, tick);
    ASSERT_GE(meter.given() - meter.returned(), -1e-9);
    ASSERT_LE(tick.counted_depth, tick.depth);
  };
  move(contact, centre(-1e-4, -0.012), centre(0.003, -0.012), 2e-6, see);
  const double soft = meter.given();
  EXPECT_NEAR(contact.state().energy.energy(), soft, 2e-3 * soft);
  move(contact, centre(0.003, -0.012), centre(0.003, 0.012), 5e-6, see);
  EXPECT_GT(contact.state().energy.energy(), soft) << "the recovery layer raises E on the way";
  EXPECT_LE(contact.state().energy.energy(), (meter.given() - meter.returned()) * (1 + 1e-3));
  move(contact, centre(0.003, 0.012), centre(-1e-4, 0.012), 2e-6, see);
  EXPECT_GE(meter.dissipated(0), -1e-3 * soft);
}

// The page: 90 % of the force is back after 4.7 depths of travel without friction, after 2.0 with 0.3.
TEST(Energy, ForceComesBackAfterATotalLoss) {
  for (const bool friction : {false, true}) {
    const Opened box(box_content(flat(friction)));
    Contact contact(box.view, 0);
    const double depth = 0.002;
    Tick tick = contact.tick(upright(centre(depth, -0.012)));
    ASSERT_EQ(length(tick.force), 0);
    double travel = 0, last = 0, most_drag = 0;
    while (tick.force.z < 0.9 * hertz(depth) && travel < 0.024) {
      travel += 5e-6;
      tick = contact.tick(upright(centre(depth, -0.012 + travel)));
      ASSERT_GE(tick.force.z, last - 1e-9);
      last = tick.force.z;
      if (!friction) most_drag = std::max(most_drag, std::hypot(tick.force.x, tick.force.y));
    }
    EXPECT_LT(travel / depth, friction ? 2.5 : 5.5) << friction;
    EXPECT_LE(most_drag, 1.001 * EnergyConstants::kRecovery * hertz(depth));
  }
}

TEST(Energy, TremorAtOnePlaceGetsNoForceFromNothing) {
  const Opened box(box_content(flat(false)));
  Contact contact(box.view, 0);
  contact.tick(upright(centre(0.002)));
  double most = 0, work = 0;
  Vec3 last, at = centre(0.002);
  for (int k = 0; k < 20000; ++k) {
    const Vec3 to = centre(0.002, 2e-5 * std::sin(0.3 * k));
    const Vec3 force = contact.tick(upright(to)).force;
    work -= 0.5 * dot(force + last, to - at);
    most = std::max(most, length(force));
    at = to;
    last = force;
  }
  EXPECT_GE(work, -1e-12);
  EXPECT_LE(contact.state().energy.energy(), work * (1 + 1e-6) + 1e-12);
  RecordProperty("most_newtons", std::to_string(most));
}

TEST(Energy, HoleInTheStoredEnergyIsBridged) {
  // Softer over 2 mm: what was stored before the dip comes back after it.
  const Opened box(graded_box([](double x) { return std::fabs(x) < 0.003 ? 0.6 : 1.0; }));
  Contact contact(box.view, 0);
  move(contact, centre(-1e-4, -0.012), centre(0.002, -0.012));
  const Tick before = contact.tick(upright(centre(0.002, -0.012)));
  const Tick after = move(contact, centre(0.002, -0.012), centre(0.002, 0.012), 5e-6);
  EXPECT_GT(after.force.z, 0.8 * before.force.z);
}

TEST(EnergyTank, CountedDepthInvertsTheStoredWork) {
  const Opened box(box_content(uniform()));
  Contact contact(box.view, 0);
  move(contact, centre(-1e-4), centre(0.001));
  const runtime::ResponseLaw& law = contact.response().law();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> draw(0, 1);
  for (int i = 0; i < 2000; ++i) {
    const double z = 1e-5 + 0.007 * draw(random), d = z * draw(random);
    const double energy = law.at(d).work, last = std::max(0.0, d - 1e-4 * draw(random));
    EXPECT_NEAR(EnergyTank::counted_depth(law, energy, z, law.at(z).work, last), d, 2e-3 * z) << z << ' ' << d;
    EXPECT_EQ(EnergyTank::counted_depth(law, 2 * law.at(z).work, z, law.at(z).work, last), z);
    EXPECT_EQ(EnergyTank::counted_depth(law, 0, z, law.at(z).work, last), 0);
    EXPECT_EQ(EnergyTank::counted_depth(law, -1, z, law.at(z).work, last), 0);
  }
}

TEST(EnergyTank, SettleKeepsAtMostWhatIsStoredOrWasALittleWhileAgo) {
  EnergyTank tank;
  tank.settle(2, 3, 0);
  EXPECT_EQ(tank.energy(), 2);
  tank.settle(5, 3, 0);
  EXPECT_EQ(tank.energy(), 3) << "not beyond what is stored";
  tank.settle(3, 1, 0.1);
  EXPECT_NEAR(tank.energy(), 2.7, 1e-15) << "held while the tool has gone a tenth of the way";
  tank.settle(tank.energy(), 1, 1);
  EXPECT_EQ(tank.energy(), 1);
  tank.settle(-1, 1, 0);
  EXPECT_EQ(tank.energy(), 0);
  tank.settle(1, 1, 0);
  tank.reset();
  EXPECT_EQ(tank.energy(), 0);
}

TEST(EnergyTank, RecoveryLimitVanishesWhereNothingIsOwed) {
  EXPECT_EQ(EnergyTank::recovery_limit(1, 7), 0);
  EXPECT_EQ(EnergyTank::recovery_limit(2, 7), 0);
  EXPECT_NEAR(EnergyTank::recovery_limit(0.5, 7), EnergyConstants::kRecovery * 7, 1e-15);
  EXPECT_GT(EnergyTank::recovery_limit(0, 7), 0) << "recovery begins from no energy";
  EXPECT_LT(EnergyTank::recovery_limit(0, 7), 0.01);
}

}  // namespace
}  // namespace palpate::energy_test
