// SPDX-License-Identifier: GPL-3.0-or-later
// The coupled law: gradients, blending, and the work of the hand over random closed motions through the anchor rule.
#include "palpate/coupled.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "palpate/coupled_check.hpp"
#include "tools/closed_motion.hpp"

namespace palpate::coupled {
namespace {

constexpr double Z = 0.005, X = 0.003;

using Random = std::mt19937_64;
double uniform(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1.0p-53;
}
Vec2 disc(Random& random, double radius) {
  const double r = radius * std::sqrt(uniform(random, 0, 1)), a = uniform(random, 0, 6.283185307179586);
  return {r * std::cos(a), r * std::sin(a)};
}

/// Coefficients that just meet the inequalities now and then, and far from always.
std::vector<double> random_coefs(const Degrees& d, Random& random) {
  const Places p = places(d);
  std::vector<double> c(static_cast<std::size_t>(p.end));
  double force = 0;
  for (int k = 0; k < p.straight; ++k) c[k] = force += uniform(random, 0, 1);
  for (int k = p.straight; k < p.stiffness; ++k) c[k] = uniform(random, -0.6, 0.6) * force;
  for (int k = p.cubic; k < p.limit; ++k) c[k] = uniform(random, -0.03, 0.03);
  for (int i = 0; i <= d.stiffness; ++i) {
    const auto cone = [&](double least) {  // mean and second harmonic above `least`, on the edge one time in four
      const Vec2 h = disc(random, 1.0);
      const double more = random() % 4 == 0 ? 0 : uniform(random, 0, 1.5);
      return Sym2{least + more + std::hypot(h.x, h.y), h.x, h.y};
    };
    const double least = margin(c.data(), d, i);
    const Sym2 plus = cone(least), minus = i < 2 ? plus : cone(least);
    double* k = c.data() + p.stiffness + 3 * i;
    k[0] = 0.5 * (plus.m + minus.m);
    k[1] = 0.5 * (plus.x + minus.x);
    k[2] = 0.5 * (plus.y + minus.y);
    if (i < 2) continue;
    double* a = c.data() + p.coupling + 3 * (i - 2);
    a[0] = 0.5 * (plus.m - minus.m);
    a[1] = 0.5 * (plus.x - minus.x);
    a[2] = 0.5 * (plus.y - minus.y);
  }
  for (int k = p.limit; k < p.end; ++k) c[k] = uniform(random, 0.1, 0.9);
  return c;
}

Law law_of(const std::vector<double>& coefs, const Degrees& d) {
  Blend blend;
  blend.clear(d);
  blend.add(coefs.data(), 1, 1, 1);
  Law law;
  law.set(blend, Z, X);
  return law;
}

std::vector<Degrees> every_kind() {
  return {kSpring,
          {2, 5, 0, 3, 0, 0, 3},
          {2, 4, 3, 2, 0, 0, 0},
          {3, 5, 4, 3, 1, 0, 2},
          {4, 6, 0, 4, 2, 1, 1},
          {4, 6, 6, 6, 6, 6, 6}};
}

TEST(Coupled, MostCoefficientsAreWhatTheLargestDegreesHave) {
  for (const Degrees& d : every_kind()) {
    EXPECT_TRUE(in_range(d));
    EXPECT_LE(count(d), kMostCoefs);
  }
  EXPECT_EQ(count(kSpring), 5);
  EXPECT_FALSE(in_range({2, 5, 0, 1, 0, 0, 3}));
  EXPECT_FALSE(in_range({2, 5, 1, 3, 0, 0, 3}));
  EXPECT_FALSE(in_range({2, 5, 0, 3, 1, 0, 3}));
  EXPECT_FALSE(in_range({5, 5, 0, 3, 1, 0, 3}));
}

// Its force grows with depth, its sideways stiffness like the radius of a contact.
TEST(Coupled, ASpringIsOne) {
  const Law law = law_of({3, 2, 0.5, 0.1, 0.4}, kSpring);
  for (const double z : {0.1 * Z, 0.5 * Z, Z, 1.5 * Z}) {
    const AtDepth at = law.at(law.abscissa(z), false);
    EXPECT_NEAR(at.push, 3 * z / Z, 1e-12);
    EXPECT_NEAR(at.limit, 0.4, 1e-12);
    EXPECT_EQ(law.coupling(at, {0.5, 0.2}), 0);
    if (z > Z) continue;
    const Vec2 force = law.push(at, {0.5, 0});
    EXPECT_NEAR(force.x, std::sqrt(z / Z) * 2.5 * 0.5, 1e-12);
    EXPECT_NEAR(force.y, std::sqrt(z / Z) * 0.1 * 0.5, 1e-12);
  }
}

TEST(Coupled, SidewaysForceIsTheGradientOfTheEnergy) {
  Random random(1);
  for (const Degrees& d : every_kind()) {
    for (int trial = 0; trial < 200; ++trial) {
      const Law law = law_of(random_coefs(d, random), d);
      const AtDepth at = law.at(uniform(random, 0.01, 1.4), true);
      const Vec2 u = disc(random, 2.5);  // beyond what is sampled, too
      const double h = 1e-6;
      const Vec2 slope{(law.energy(at, u + Vec2{h, 0}) - law.energy(at, u - Vec2{h, 0})) / (2 * h),
                       (law.energy(at, u + Vec2{0, h}) - law.energy(at, u - Vec2{0, h})) / (2 * h)};
      const Vec2 force = law.push(at, u);
      ASSERT_NEAR(force.x, slope.x, 1e-6);
      ASSERT_NEAR(force.y, slope.y, 1e-6);
      if (std::hypot(u.x, u.y) > 0.999) continue;
      const Sym2 k = at.energy.hessian(u, d.order);
      const Vec2 step = disc(random, 1.0), change = times(k, step);
      const Vec2 seen = (1 / (2 * h)) * (law.push(at, u + h * step) - law.push(at, u - h * step));
      ASSERT_NEAR(change.x, seen.x, 1e-5);
      ASSERT_NEAR(change.y, seen.y, 1e-5);
      ASSERT_GE(k.m - std::hypot(k.x, k.y), -1e-12) << "V is convex where it was sampled";
    }
  }
}

TEST(Coupled, RatesAreDerivativesAndNothingJumpsAtTheDepthScale) {
  Random random(2);
  for (const Degrees& d : every_kind()) {
    const Law law = law_of(random_coefs(d, random), d);
    for (const double t : {0.2, 0.7, 0.999999, 1.000001, 1.3}) {
      const double h = 1e-7;
      const AtDepth low = law.at(t - h, true), high = law.at(t + h, true), at = law.at(t, true);
      const Vec2 u{0.3, -0.4};
      EXPECT_NEAR(at.rate.value(u, d.order), (high.energy.value(u, d.order) - low.energy.value(u, d.order)) / (2 * h),
                  1e-4);
      EXPECT_NEAR(2 * at.s * at.slope.x, (high.straight.x - low.straight.x) / (2 * h), 1e-4);
    }
    for (const double t : {0.5, 1.0}) {
      const AtDepth low = law.at(t - 1e-9, true), high = law.at(t + 1e-9, true);
      const Vec2 u{-0.5, 0.7};
      EXPECT_NEAR(low.push, high.push, 1e-6);
      EXPECT_NEAR(law.push(low, u).x, law.push(high, u).x, 1e-6);
      EXPECT_NEAR(law.coupling(low, u), law.coupling(high, u), 1e-6);
    }
    const AtDepth zero = law.at(1e-9, true);
    EXPECT_NEAR(zero.push, 0, 1e-12);
    EXPECT_NEAR(std::hypot(law.push(zero, {1, 1}).x, law.push(zero, {1, 1}).y), 0, 1e-6);
    if (d.straight == 0) {
      EXPECT_NEAR(law.coupling(zero, {1, 1}), 0, 1e-6) << "a contact that is lifted under load ends without force";
    }
  }
}

TEST(Coupled, BlendsTurnWithTheirFrames) {
  Random random(3);
  for (const Degrees& d : every_kind()) {
    const std::vector<double> coefs = random_coefs(d, random);
    const Law own = law_of(coefs, d);
    const double angle = 0.8;
    const Vec2 turned{std::cos(angle), std::sin(angle)};
    Blend blend;
    blend.clear(d);
    blend.add(coefs.data(), 0.25, 0.25, 1, turned);
    blend.add(coefs.data(), 1, 1, 0.75, turned);
    Law law;
    law.set(blend, Z, X);
    for (const double t : {0.3, 0.9, 1.2}) {
      const AtDepth a = own.at(t, true), b = law.at(t, true);
      const Vec2 u = disc(random, 1.5), v = product(u, turned);
      const Vec2 expected = product(own.push(a, u), turned), got = law.push(b, v);
      EXPECT_NEAR(expected.x, got.x, 1e-12);
      EXPECT_NEAR(expected.y, got.y, 1e-12);
      EXPECT_NEAR(own.coupling(a, u), law.coupling(b, v), 1e-11);
      EXPECT_NEAR(a.push, b.push, 1e-12);
      EXPECT_NEAR(a.limit, b.limit, 1e-12);
    }
  }
}

TEST(Coupled, DeepeningInOneTickIsNearlyDeepeningInMany) {
  for (const double growth : {1.05, 1.25}) {
    Random random(5);
    std::vector<double> apart;
    for (int trial = 0; trial < 1200; ++trial) {
      const Degrees d = every_kind()[static_cast<std::size_t>(trial) % 6];
      const Law law = law_of(random_coefs(d, random), d);
      const double t0 = 0.05 * std::pow(20.0, uniform(random, 0, 1));
      const Vec2 u = disc(random, 1);
      constexpr int kTicks = 100;
      Vec2 fine = u;
      for (int k = 0; k < kTicks; ++k) {
        fine = law.deepen(t0 * (1 + (growth - 1) * k / kTicks), t0 * (1 + (growth - 1) * (k + 1) / kTicks), fine);
      }
      const Vec2 off = law.deepen(t0, growth * t0, u) - fine;
      apart.push_back(std::sqrt(dot(off, off) / dot(u, u)));
    }
    std::sort(apart.begin(), apart.end());
    EXPECT_LE(apart[apart.size() * 2 / 3], 1e-5) << growth << ": one step where the rule's own loss is enough";
    EXPECT_LE(apart[apart.size() * 19 / 20], 0.01) << growth;
  }
}

// Core and rim go deeper in one go where they can: as each alone.
TEST(Coupled, TwoPartsSideBySideGoAsEachAlone) {
  Random random(6);
  const double lean[2] = {0.7, 1.3};
  int laws = 0, at_once = 0, coupled = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const Degrees d = every_kind()[static_cast<std::size_t>(trial) % 6];
    const Law law = law_of(random_coefs(d, random), d);
    const double t0 = 0.05 * std::pow(20.0, uniform(random, 0, 1)), t1 = t0 * uniform(random, 1, 1.04);
    const AtDepth from = law.at(t0, true), to = law.at(t1, true);
    const Vec2 u[2] = {disc(random, 1), disc(random, 0.1)};
    const runtime::Two leans = runtime::two(lean[0], lean[1]);
    const Vec2Of<runtime::Two> before{runtime::two(u[0].x, u[1].x), runtime::two(u[0].y, u[1].y)};
    Vec2Of<runtime::Two> both = before;
    runtime::Two force{};
    const bool deeper = law.deepen_at_once(t0, from, t1, to, both, leans),
               couples = law.couple_at_once(from, before, leans, force);
    laws += d.order == 2;
    at_once += deeper;
    coupled += couples;
    ASSERT_TRUE(d.order == 2 || !(deeper || couples));
    for (int k = 0; k < 2; ++k) {
      const Vec2 alone = deeper ? law.deepen(t0, from, t1, to, u[k], lean[k]) : u[k];
      ASSERT_NEAR(both.x[k], alone.x, 1e-12) << trial;
      ASSERT_NEAR(both.y[k], alone.y, 1e-12) << trial;
      if (!couples) continue;
      const auto push = [&] { return lean[k] * from.straight + from.energy.gradient(u[k], d.order); };
      ASSERT_NEAR(force[k], law.coupling(from, u[k], push, lean[k]), 1e-12) << trial;
    }
  }
  EXPECT_GT(at_once, 0.7 * laws);
  EXPECT_GT(coupled, 0.7 * laws);
}

// Along a line that nothing resists an anchor has no reason to move.
TEST(Coupled, WhatNothingResistsStaysAsItGoesDeeper) {
  const Degrees d{2, 4, 4, 2, 0, 0, 0};
  const Places p = places(d);
  for (const double stiffness : {0.0, 1.0}) {
    std::vector<double> coefs(static_cast<std::size_t>(count(d)), 0.0);
    for (int k = 0; k < p.straight; ++k) coefs[k] = 1 + k;
    for (int k = p.straight; k < p.stiffness; ++k) coefs[k] = 0.4;
    for (int i = 0; i <= d.stiffness; ++i) {
      coefs[p.stiffness + 3 * i] = coefs[p.stiffness + 3 * i + 1] = stiffness;  // along x, or nowhere
    }
    const Law law = law_of(coefs, d);
    for (const double t : {0.1, 0.5, 1.2}) {
      const Vec2 u{0.3, -0.4}, kept = law.deepen(t, t * (1 + 1e-9), u);
      EXPECT_NEAR(kept.x, u.x, 1e-6) << stiffness << ' ' << t;
      EXPECT_NEAR(kept.y, u.y, 1e-6) << stiffness << ' ' << t;
    }
  }
}

TEST(Coupled, NoClosedMotionGainsEnergy) {
  // From no contact to no contact: deeper and less deep under side load, reversals, large and tiny; every clamp off.
  Random random(4);
  int motions = 0;
  double worst = 0;
  for (int round = 0; motions < 100000; ++round) {
    const Degrees d = every_kind()[static_cast<std::size_t>(round) % 5];
    const Law law = law_of(random_coefs(d, random), d);
    for (int motion = 0; motion < 20; ++motion, ++motions) {
      cli::ClosedMotion contact(law, Z, X, 0.01);
      const double size = std::pow(10.0, uniform(random, -3, 0));
      contact.depth(uniform(random, 0.05, 0.8));
      const int legs = 2 + static_cast<int>(random() % 3);
      for (int leg = 0; leg < legs; ++leg) {
        contact.sideways(disc(random, size));
        contact.depth(std::clamp(contact.at() + uniform(random, -0.2, 0.2) * size, 0.02, 1.2));
      }
      contact.depth(0);
      worst = std::min(worst, contact.work() / contact.gross());
      ASSERT_GE(contact.work(), -1e-9 * contact.gross()) << round << ' ' << motion;
    }
  }
  RecordProperty("worst", std::to_string(worst));
}

// With a coupling beyond the stiffness, lifting under side load gives more than deepening took.
TEST(Coupled, AMotionSeesALawThatIsNotPassive) {
  const Degrees d{2, 2, 0, 2, 0, 0, 0};
  std::vector<double> coefs(static_cast<std::size_t>(count(d)), 0.0);
  const Places p = places(d);
  coefs[0] = 1;
  for (int i = 0; i <= d.stiffness; ++i) coefs[p.stiffness + 3 * i] = 1;
  for (const double coupling : {0.9, 20.0}) {
    coefs[p.coupling] = coupling;
    const Law law = law_of(coefs, d);
    double worst = 0;
    for (const double from : {0.3, 0.6}) {
      cli::ClosedMotion motion(law, Z, X, 0.01);
      motion.depth(from);
      motion.sideways({0.8, 0});
      motion.depth(0.9 - from);
      motion.sideways({-0.8, 0});
      motion.depth(0);
      worst = std::min(worst, motion.work() / motion.gross());
    }
    EXPECT_EQ(worst<-1e-3, std::abs(coupling)> 1) << coupling << ' ' << worst;
    EXPECT_EQ(broken_rule(coefs.data(), d, 10) != nullptr, coupling > 1) << coupling;
  }
}

}  // namespace
}  // namespace palpate::coupled
