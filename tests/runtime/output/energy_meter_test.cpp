// SPDX-License-Identifier: GPL-3.0-or-later
// The meter of the hand's work against closed forms: a press, rotations about a point, wrong poses.
#include "palpate/output/energy_meter.hpp"

#include <cmath>
#include <limits>

#include "tests/runtime/support.hpp"

namespace palpate::energy_meter_test {
namespace {

using namespace test;
using runtime::EnergyMeter;

TEST(EnergyMeter, PressAndLiftGiveAndReturnTheStoredWork) {
  const Opened box(box_content(flat()));
  runtime::Contact contact(box.view, 0);
  EnergyMeter meter;
  const auto see = [&](const Pose& pose, const Tick& tick) { meter.add(pose, tick); };
  move(contact, centre(-0.001), centre(0.003), 1e-6, see);
  const double stored = contact.response().law().at(0.003).work;
  EXPECT_NEAR(meter.given(), stored, 1e-3 * stored);
  EXPECT_EQ(meter.returned(), 0);
  EXPECT_NEAR(meter.dissipated(contact.state().energy.energy()), 0, 1e-3 * stored);
  move(contact, centre(0.003), centre(-0.001), 1e-6, see);
  EXPECT_NEAR(meter.returned(), stored, 1e-3 * stored);
  meter.reset();
  EXPECT_EQ(meter.given() + meter.returned(), 0);
}

// A force at a point of a tool that turns about that point does no work: the torque about the origin takes back what the
// way of the origin gives.
TEST(EnergyMeter, RotationAboutThePointOfTheForceDoesNoWork) {
  EnergyMeter meter;
  const Vec3 point{0.01, 0.02, 0.03}, force{1, -2, 3}, arm{0.004, 0, 0.03};
  for (int i = 0; i <= 2000; ++i) {
    Pose pose = turned(5e-4 * i, unit(Vec3{1, 2, -1}, {}), {});
    pose.translation = point - pose.rotate(arm);
    Tick tick;
    tick.force = force;
    tick.torque = cross(point - pose.translation, force);
    meter.add(pose, tick);
  }
  EXPECT_LT(meter.given() + meter.returned(), 1e-7);
}

TEST(EnergyMeter, WrongPoseEndsThePathAndKeepsTheSums) {
  EnergyMeter meter;
  Tick tick;
  tick.force = {0, 0, 2};
  meter.add(upright({0, 0, 0}), tick);
  meter.add(upright({0, 0, -0.001}), tick);
  EXPECT_NEAR(meter.given(), 0.002, 1e-15);
  meter.add(upright({std::numeric_limits<double>::quiet_NaN(), 0, 0}), tick);
  meter.add(upright({0, 0, 5}), tick);
  EXPECT_NEAR(meter.given(), 0.002, 1e-15);
  meter.add(upright({0, 0, 5.001}), tick);
  EXPECT_NEAR(meter.returned(), 0.002, 1e-12);
}

}  // namespace
}  // namespace palpate::energy_meter_test
