// SPDX-License-Identifier: GPL-3.0-or-later
// Factors that change while a tool presses: no tear in the force, no energy from nowhere.
#include "palpate/body/stiffness_scale.hpp"

#include <cmath>
#include <vector>

#include "tests/runtime/allocation_counter.hpp"
#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::AdjustedContact;
using runtime::Contact;
using runtime::SiteScales;

constexpr double kStep = 1e-3;  // s
constexpr double kRate = 5;     // 1/s

struct Adjusted {
  Opened file;
  std::vector<SiteScales::Scale> memory;
  SiteScales scales;
  explicit Adjusted(const Options& options)
      : file(box_content(options)), memory(file.view.meta->site_count), scales(file.view, memory.data()) {}
  void set_all(float scale) {
    for (std::uint32_t i = 0; i < file.view.meta->site_count; ++i) ASSERT_TRUE(scales.set(i, scale));
  }
};

/// With the tip so deep in the box's top.
Pose at_depth(double depth, double x = 0.004, double y = 0.002) { return upright({x, y, kTop + kTipRadius - depth}); }

TEST(Adjust, FactorsScaleForceTorqueAndLimit) {
  Adjusted a(uniform());
  a.set_all(0.4f);
  AdjustedContact adjusted(a.file.view, 0, a.scales, kRate);
  Contact plain(a.file.view, 0);
  for (int k = -5; k <= 100; ++k) {
    const Pose pose = at_depth(3e-5 * k, 0.004 + 2e-5 * std::max(0, k - 50));
    const Tick t = adjusted.tick(pose, kStep), p = plain.tick(pose);
    EXPECT_EQ(t.state, p.state);
    EXPECT_LT(distance(t.force, static_cast<double>(0.4f) * p.force), 1e-12);
    EXPECT_LT(distance(t.torque, static_cast<double>(0.4f) * p.torque), 1e-12);
    EXPECT_NEAR(t.friction_limit, static_cast<double>(0.4f) * p.friction_limit, 1e-12);
  }
}

TEST(Adjust, WrongFactorsAreRefused) {
  Adjusted a(uniform());
  EXPECT_FALSE(a.scales.set(a.file.view.meta->site_count, 1));
  EXPECT_FALSE(a.scales.set(0, -0.1f));
  EXPECT_FALSE(a.scales.set(0, std::nanf("")));
  EXPECT_FALSE(a.scales.set(0, 101));
  EXPECT_EQ(a.scales.at(0), 1.0f);
}

TEST(Adjust, AFallIsARampAndARiseWaits) {
  Adjusted a(uniform());
  AdjustedContact contact(a.file.view, 0, a.scales, kRate);
  contact.tick(at_depth(-0.001), kStep);
  for (int k = 0; k <= 30; ++k) contact.tick(at_depth(1e-4 * k), kStep);
  const double full = length(contact.tick(at_depth(0.003), kStep).force);
  EXPECT_NEAR(full, hertz(0.003), 0.02 * full);
  a.set_all(0.5f);
  double last = full;
  for (int k = 0; k < 200; ++k) {
    const double force = length(contact.tick(at_depth(0.003), kStep).force);
    EXPECT_LE(last - force, full * kRate * kStep * (1 + 1e-9));
    EXPECT_LE(force, last);
    if (k == 80) {
      EXPECT_GT(force, 0.55 * full);
    }
    if (k >= 100) {
      EXPECT_NEAR(force, 0.5 * full, 1e-9);
    }
    last = force;
  }
  a.set_all(2);
  for (int k = 0; k < 300; ++k) EXPECT_NEAR(length(contact.tick(at_depth(0.003), kStep).force), 0.5 * full, 1e-9);
  for (int k = 30; k >= -5; --k) contact.tick(at_depth(1e-4 * k), kStep);
  for (int k = -5; k <= 30; ++k) contact.tick(at_depth(1e-4 * k), kStep);
  EXPECT_NEAR(length(contact.tick(at_depth(0.003), kStep).force), 2 * full, 1e-9) << "of the next contact";
}

// What the curves hold at a depth that was reached under a factor of 0 was given by nobody.
TEST(Adjust, AFactorThatRisesFromNothingGivesNothingBack) {
  for (const float at_first : {0.0f, 1.0f}) {
    for (const bool friction : {false, true}) {
      Options options = uniform();
      options.friction = friction;
      Adjusted a(options);
      a.set_all(at_first);
      AdjustedContact contact(a.file.view, 0, a.scales, kRate);
      double given = 0, returned = 0;
      Tick last;
      const auto move = [&](double from, double to) {
        const Tick tick = contact.tick(at_depth(to), kStep);
        const double work = 0.5 * (last.force.z + tick.force.z) * (to - from);
        (work > 0 ? given : returned) += std::fabs(work);
        last = tick;
      };
      for (int k = -10; k < 300; ++k) move(1e-5 * k, 1e-5 * (k + 1));
      a.set_all(0);
      for (int k = 0; k < 300; ++k) move(0.003, 0.003);
      EXPECT_EQ(length(last.force), 0);
      a.set_all(1);
      for (int k = 0; k < 300; ++k) move(0.003, 0.003);
      for (int k = 300; k > -10; --k) move(1e-5 * k, 1e-5 * (k - 1));
      EXPECT_LE(returned, given + 1e-6) << at_first << ' ' << friction;  // J, of about 1e-3
    }
  }
}

// Drawn over sites of other factors the force follows the way, and a leap to one of them is a ramp as well.
TEST(Adjust, SlidingIntoOtherFactorsDoesNotTear) {
  Options options = uniform();
  options.friction = false;
  Adjusted a(options);
  std::mt19937 random(7);
  for (std::uint32_t i = 0; i < a.file.view.meta->site_count; ++i) {
    a.scales.set(i, std::uniform_real_distribution<float>(0.2f, 3)(random));
  }
  AdjustedContact contact(a.file.view, 0, a.scales, kRate);
  Contact plain(a.file.view, 0);
  const auto tick = [&](double depth, double x, double y) {
    const Tick own = contact.tick(at_depth(depth, x, y), kStep), file = plain.tick(at_depth(depth, x, y));
    // The place's own force, but for the depth that is held back where the hand gave less than half of what is stored.
    EXPECT_GE(length(own.force), 0.5 * contact.scale() * length(file.force));
    const auto& field = contact.contact().field();
    if (own.depth > 0) {
      const Vec3 expected = contact.scale() * field.at_depth(own.depth).normal_force * field.normal();
      EXPECT_LT(distance(own.force, expected), 1e-9 + 1e-6 * length(expected));
    }
    return contact.scale();
  };
  for (int k = -100; k <= 200; ++k) tick(1e-5 * k, -0.02, -0.006);
  double last = contact.scale(), least = last, most = last;
  const auto follow = [&](double x, double y) {
    const double scale = tick(0.002, x, y);
    EXPECT_LE(std::fabs(scale - last), kRate * kStep * (1 + 1e-9));
    least = std::min(least, scale);
    most = std::max(most, scale);
    last = scale;
  };
  for (double x = -0.02; x < 0.02; x += 1e-5) follow(x, 0.3 * x);
  EXPECT_GT(most, 1.3 * least) << "it went through different places";
  for (int k = 0; k < 200; ++k) follow(0.013, 0.006);  // 7 mm away
}

// A site that c keeps does not take a higher factor; one that it comes to does.
TEST(Adjust, AStifferPlaceIsFeltOnTheWayThere) {
  Options options = uniform();
  options.friction = false;
  Adjusted a(options);
  AdjustedContact contact(a.file.view, 0, a.scales, kRate);
  for (int k = -10; k <= 100; ++k) contact.tick(at_depth(2e-5 * k, -0.02, 0), kStep);
  a.set_all(2);
  for (int k = 0; k < 500; ++k) contact.tick(at_depth(0.002, -0.02, 0), kStep);
  EXPECT_NEAR(contact.scale(), 1, 1e-12);
  for (double x = -0.02; x < 0.02; x += 1e-5) contact.tick(at_depth(0.002, x, 0), kStep);
  EXPECT_NEAR(contact.scale(), 2, 1e-9);
}

// Random pushes, lifts and sideways moves of contacts that stick, factors that change all the time: each contact takes
// work and gives back less. The bodies' own friction is left out: it would hide what the factors give.
TEST(Adjust, NoContactGivesMoreThanItTook) {
  Options options = uniform();
  options.friction = false;
  Adjusted a(options);
  AdjustedContact contact(a.file.view, 0, a.scales, kRate);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0, 1);
  double depth = -0.0005, target = 0.003, work = 0, taken = 0;
  Tick last = contact.tick(at_depth(depth), kStep);
  int contacts = 0, changes = 0;
  for (int i = 0; i < 150000; ++i) {
    if (random() % 50 == 0) {
      a.set_all(static_cast<float>(3 * share(random)));
      ++changes;
    }
    if (std::fabs(depth - target) < 2e-6) target = 0.004 * share(random) - 0.0008;
    const double step = std::clamp(target - depth, -1e-6, 1e-6);
    depth += step;
    const Tick t = contact.tick(at_depth(depth), kStep);
    work += 0.5 * (t.force.z + last.force.z) * step;  // of the hand on the body
    taken = std::max(taken, work);
    last = t;
    if (t.state == State::released) {
      EXPECT_GE(work, -1e-6 * taken) << "contact " << contacts;
      work = taken = 0;
      ++contacts;
    }
  }
  EXPECT_GT(contacts, 7);
  EXPECT_GT(changes, 1000);
}

TEST(Adjust, AllocatesNothing) {
  Options options = uniform();
  Adjusted a(options);
  AdjustedContact contact(a.file.view, 0, a.scales, kRate);
  const long before = allocations();
  double sum = 0;
  for (int k = 0; k < 1000; ++k) {
    a.scales.set(static_cast<std::uint32_t>(k) % a.file.view.meta->site_count, 0.5f);
    sum += contact.tick(at_depth(3e-6 * k - 1e-4), kStep).force.z;
  }
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(sum, 0);
}

}  // namespace
}  // namespace palpate
