// SPDX-License-Identifier: GPL-3.0-or-later
// Stiffness factors that change while a tool presses: scaled forces, ramps, no energy from a factor that rises.
#include "palpate/body/stiffness_scale.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/runtime/allocation_counter.hpp"
#include "tests/runtime/support.hpp"

namespace palpate::stiffness_scale_test {
namespace {

using namespace test;
using runtime::Contact;
using runtime::EnergyMeter;
using runtime::SiteScales;
using runtime::StiffnessScale;
using runtime::StillBody;

constexpr double kStep = 5e-3;

struct Scaled {
  Opened file;
  std::vector<SiteScales::Scale> memory;
  SiteScales scales;
  StiffnessScale<StillBody> body;
  explicit Scaled(const Options& options)
      : file(box_content(options)),
        memory(file.view.meta->site_count),
        scales(file.view, memory.data()),
        body{{&file.view}, &scales, &file.view, kStep} {}
  void set_all(float scale) {
    for (std::uint32_t i = 0; i < file.view.meta->site_count; ++i) ASSERT_TRUE(scales.set(i, scale));
  }
};

Pose at_depth(double depth, double x = 0.004, double y = 0.002) { return upright(centre(depth, x, y)); }

TEST(StiffnessScale, FactorScalesForceTorqueAndLimit) {
  Scaled a(uniform());
  a.set_all(0.4f);
  Contact scaled(a.file.view, 0), plain(a.file.view, 0);
  for (int k = -5; k <= 100; ++k) {
    const Pose pose = at_depth(3e-5 * k, 0.004 + 2e-5 * std::max(0, k - 50));
    const Tick t = scaled.tick(pose, a.body), p = plain.tick(pose);
    EXPECT_EQ(t.state, p.state);
    EXPECT_LT(distance(t.force, double{0.4f} * p.force), 1e-9);
    EXPECT_LT(distance(t.torque, double{0.4f} * p.torque), 1e-11);
    EXPECT_NEAR(t.friction_limit, double{0.4f} * p.friction_limit, 1e-9);
    EXPECT_EQ(t.counted_depth, t.depth);
  }
}

TEST(StiffnessScale, WrongFactorsAreRefused) {
  Scaled a(uniform());
  EXPECT_FALSE(a.scales.set(a.file.view.meta->site_count, 1));
  EXPECT_FALSE(a.scales.set(0, -0.1f));
  EXPECT_FALSE(a.scales.set(0, std::nanf("")));
  EXPECT_FALSE(a.scales.set(0, 101));
  EXPECT_EQ(a.scales.at(0), 1.0f);
}

TEST(StiffnessScale, FallIsARampAndARiseAtRestGivesNoForce) {
  Scaled a(uniform());
  Contact contact(a.file.view, 0);
  for (int k = -10; k <= 30; ++k) contact.tick(at_depth(1e-4 * k), a.body);
  const double full = length(contact.tick(at_depth(0.003), a.body).force);
  EXPECT_NEAR(full, hertz(0.003), 0.02 * full);
  a.set_all(0.5f);
  double last = full;
  for (int k = 0; k < 200; ++k) {
    const double force = length(contact.tick(at_depth(0.003), a.body).force);
    EXPECT_LE(last - force, full * kStep * (1 + 1e-9));
    EXPECT_LE(force, last * (1 + 1e-12));
    if (k == 80) {
      EXPECT_GT(force, 0.55 * full);
    }
    if (k >= 100) {
      EXPECT_NEAR(force, 0.5 * full, 1e-3 * full);
    }
    last = force;
  }
  a.set_all(2);
  for (int k = 0; k < 300; ++k) contact.tick(at_depth(0.003), a.body);
  const Tick risen = contact.tick(at_depth(0.003), a.body);
  EXPECT_LT(risen.counted_depth, risen.depth) << "the hand has not put in what the whole depth stores now";
  // E is that of the factor 1. W grows like the depth^2.5, so at one energy F grows like the factor^0.4.
  EXPECT_LT(length(risen.force), 1.1 * std::pow(2, 0.4) * full);
  for (int k = 30; k >= -5; --k) contact.tick(at_depth(1e-4 * k), a.body);
  for (int k = -5; k <= 30; ++k) contact.tick(at_depth(1e-4 * k), a.body);
  EXPECT_NEAR(length(contact.tick(at_depth(0.003), a.body).force), 2 * full, 0.02 * full) << "of the next contact";
}

// A rise of the factor stores nothing that the hand did not put in.
TEST(StiffnessScale, RiseOfTheFactorGivesNoEnergy) {
  for (const float first : {0.0f, 1.0f}) {
    for (const bool friction : {false, true}) {
      Scaled a(flat(friction));
      a.set_all(first);
      Contact contact(a.file.view, 0);
      EnergyMeter meter;
      const auto go = [&](double depth) {
        const Tick tick = contact.tick(at_depth(depth), a.body);
        meter.add(at_depth(depth), tick);
        return tick;
      };
      for (int k = -10; k < 300; ++k) go(1e-5 * (k + 1));
      a.set_all(0);
      for (int k = 0; k < 300; ++k) go(0.003);
      EXPECT_EQ(length(go(0.003).force), 0);
      a.set_all(1);
      for (int k = 0; k < 300; ++k) go(0.003);
      for (int k = 300; k > -10; --k) go(1e-5 * (k - 1));
      EXPECT_LE(meter.returned(), meter.given() + 2e-6) << first << ' ' << friction;  // J, of about 1e-3
    }
  }
}

TEST(StiffnessScale, RiseAtRestLeavesTheEnergyWhateverItsStep) {
  for (const bool friction : {false, true}) {
    for (const double step : {0.01, 0.1, 1.0, 100.0}) {
      Scaled a(flat(friction));
      a.body.step = step;
      Contact contact(a.file.view, 0);
      EnergyMeter meter;
      const auto go = [&](double depth) {
        const Tick tick = contact.tick(at_depth(depth), a.body);
        meter.add(at_depth(depth), tick);
        return contact.state().energy.energy();
      };
      for (int k = -10; k < 300; ++k) go(1e-5 * (k + 1));
      const double pressed = go(0.003);
      a.set_all(4);
      for (int k = 0; k < 400; ++k) ASSERT_LE(go(0.003), pressed * (1 + 1e-12)) << step << ' ' << k;
      EXPECT_LE(4 * contact.response().law().normal(contact.state().counted_depth).work, pressed * 1.001) << step;
      for (int k = 300; k > -10; --k) go(1e-5 * (k - 1));
      EXPECT_LE(meter.returned(), meter.given() + 1e-4 * pressed) << step << ' ' << friction;
    }
  }
}

TEST(StiffnessScale, ForceFollowsAFactorThatChangesOverTheBody) {
  Scaled a(flat(false));
  std::mt19937 random(7);
  for (std::uint32_t i = 0; i < a.file.view.meta->site_count; ++i) {
    a.scales.set(i, std::uniform_real_distribution<float>(0.2f, 3)(random));
  }
  Contact contact(a.file.view, 0);
  for (int k = -100; k <= 200; ++k) contact.tick(at_depth(1e-5 * k, -0.02, -0.006), a.body);
  double last = contact.state().factor, least = last, most = last;
  Vec3 force = contact.state().applied.force;
  for (double x = -0.02; x < 0.02; x += 1e-5) {
    const Tick tick = contact.tick(at_depth(0.002, x, 0.3 * x), a.body);
    const double factor = contact.state().factor;
    EXPECT_LE(std::fabs(factor - last), kStep * (1 + 1e-9));
    EXPECT_LT(distance(tick.force, force), 3 * 3000 * 2 * 1e-5 + kStep * hertz(0.002));
    least = std::min(least, factor);
    most = std::max(most, factor);
    last = factor;
    force = tick.force;
  }
  EXPECT_GT(most, 1.3 * least) << "it went over different places";
}

// Frictionless, so that no slip hides what the factors would give.
TEST(StiffnessScale, NoContactGivesMoreThanItTook) {
  Scaled a(flat(false));
  Contact contact(a.file.view, 0);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0, 1);
  double depth = -0.0005, target = 0.003, work = 0, taken = 0, worst = 0;
  Tick last = contact.tick(at_depth(depth), a.body);
  int contacts = 0, changes = 0;
  for (int i = 0; i < 60000; ++i) {
    if (random() % 50 == 0) {
      a.set_all(static_cast<float>(3 * share(random)));
      ++changes;
    }
    if (std::fabs(depth - target) < 4e-6) target = 0.004 * share(random) - 0.0008;
    const double step = std::clamp(target - depth, -2e-6, 2e-6);
    depth += step;
    const Tick t = contact.tick(at_depth(depth), a.body);
    work += 0.5 * (t.force.z + last.force.z) * step;
    taken = std::max(taken, work);
    last = t;
    if (t.state == State::released) {
      worst = std::min(worst, work / taken);
      work = taken = 0;
      ++contacts;
    }
  }
  EXPECT_GT(worst, -1e-3);
  EXPECT_GT(contacts, 5);
  EXPECT_GT(changes, 1000);
}

TEST(StiffnessScale, TicksAllocateNothing) {
  Scaled a(uniform());
  Contact contact(a.file.view, 0);
  const long before = allocations();
  double sum = 0;
  for (int k = 0; k < 1000; ++k) {
    a.scales.set(static_cast<std::uint32_t>(k) % a.file.view.meta->site_count, 0.5f);
    sum += contact.tick(at_depth(3e-6 * k - 1e-4), a.body).force.z;
  }
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(sum, 0);
}

}  // namespace
}  // namespace palpate::stiffness_scale_test
