// SPDX-License-Identifier: GPL-3.0-or-later
// The coupled model in a contact: the file's law, the anchor rule, work over closed motions, continuity over patches.
#include <algorithm>
#include <cmath>

#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;

Options coupled_options(int order, bool same) {
  Options options;
  options.coupled = order;
  options.uniform = same;
  return options;
}

/// Tip at depth z (m) under the box's top, moved sideways.
Pose tip(double x, double y, double z) { return upright({0.003 + x, 0.002 + y, kTop + kTipRadius - z}); }

TEST(CoupledContact, PushAndSidewaysAnswerByTheFilesLaw) {
  const Opened box(box_content(coupled_options(2, true)));
  Contact contact(box.view, 0);
  for (double z = -0.1e-3; z < 2e-3; z += 0.02e-3) contact.tick(tip(0, 0, z));
  const Tick straight = contact.tick(tip(0, 0, 2e-3));
  const double s = std::sqrt(2e-3 / kDepthScale);
  EXPECT_NEAR(straight.force.z, hertz(2e-3), 1e-3);
  EXPECT_NEAR(straight.friction_limit, 0.3 * hertz(2e-3), 1e-3);
  const Tick sideways = contact.tick(tip(0.2e-3, 0, 2e-3));
  EXPECT_EQ(sideways.state, State::stick);
  // The sites' frames all have x along the body's x on the top.
  const double u = 0.2e-3 / kSidewaysScale, unit = kHertzForce;
  EXPECT_NEAR(std::hypot(sideways.force.x, sideways.force.y), unit * s * u * 0.75, 0.1 * unit * s * u * 0.75);
  EXPECT_LT(sideways.force.x, 0);
  const double coupling = -0.2 * (3 * s * s * (1 - s) + s * s * s) * u * u / (4 * s) * kSidewaysScale / kDepthScale;
  EXPECT_NEAR(sideways.force.z - straight.force.z, unit * coupling, 1e-5 * unit);
}

TEST(CoupledContact, DeeperUnderSideLoadKeepsTheForceAndLiftingKeepsTheDeflection) {
  const Opened box(box_content(coupled_options(2, true)));
  Contact contact(box.view, 0);
  for (double z = -0.1e-3; z <= 1.5e-3; z += 0.02e-3) contact.tick(tip(0, 0, z));
  const auto sideways = [](const Tick& t) { return std::hypot(t.force.x, t.force.y); };
  const double before = sideways(contact.tick(tip(0.1e-3, 0, 1.5e-3)));
  Tick deep;
  for (double z = 1.5e-3; z <= 3e-3; z += 0.02e-3) deep = contact.tick(tip(0.1e-3, 0, z));
  EXPECT_EQ(deep.state, State::stick);
  EXPECT_NEAR(sideways(deep), before, 1e-6);
  Tick lifted;
  for (double z = deep.depth; z >= 2e-3; z -= 0.02e-3) lifted = contact.tick(tip(0.1e-3, 0, z));
  EXPECT_NEAR(sideways(lifted), sideways(deep) * std::sqrt(lifted.depth / deep.depth), 1e-3 * before);
}

// From free to free through sticking and sliding. The work of ticks is a sum over trapezoids, which errs by the square
// of the step: it is compared with what went through the hand.
TEST(CoupledContact, NoClosedMotionGivesWork) {
  std::mt19937 random(41);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  for (const int kind : {2, 4, -3}) {
    Options options = coupled_options(std::abs(kind), true);
    options.rim = kind < 0;
    const Opened box(box_content(options));
    Contact contact(box.view, 0);
    int slid = 0, stuck = 0;
    for (int motion = 0; motion < 300; ++motion) {
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
        go({0.003 + uniform(-0.5e-3, 0.5e-3), 0.002 + uniform(-0.5e-3, 0.5e-3),
            kTop + kTipRadius - uniform(0.1e-3, 2e-3)});
      }
      go({at.x, at.y, start.z});
      go(start);
      ASSERT_EQ(last.depth, 0);
      ASSERT_GE(work, -2e-4 * gross) << kind << ' ' << motion;
    }
    EXPECT_GT(slid, 1000);
    EXPECT_GT(stuck, 1000);
  }
}

TEST(CoupledContact, AtOneDepthLoopsDoNoWork) {
  const Opened ball(ball_content(coupled_options(4, false)));
  std::mt19937 random(42);
  const runtime::Field field(ball.view, 0, {17, {0.2, 0.5, 0.3}}, {});
  const Vec3& n = field.normal();
  const Vec3 x = runtime::any_orthogonal(n), y = cross(n, x);
  for (const double z : {0.2e-3, 2e-3, 6e-3}) {
    // Gauss' rule of 3 points a side is exact for a law of order 4.
    const double at[] = {0.1127016653792583, 0.5, 0.8872983346207417}, weight[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    Vec3 corner[5];
    for (int k = 0; k < 4; ++k) {
      const auto draw = [&] { return 0.7 * kSidewaysScale * (2 * (static_cast<double>(random()) / 4294967296.0) - 1); };
      corner[k] = draw() * x + draw() * y;
    }
    corner[4] = corner[0];
    double work = 0, gross = 0;
    for (int k = 0; k < 4; ++k) {
      const Vec3 side = corner[k + 1] - corner[k];
      for (int g = 0; g < 3; ++g) {
        const double w = weight[g] * dot(field.force(corner[k] + at[g] * side - z * n).tangential, side);
        work += w;
        gross += std::abs(w);
      }
    }
    EXPECT_LT(std::abs(work), 1e-14 * gross);
  }
}

TEST(CoupledContact, BlendsAreContinuousOverEdges) {
  Options options = coupled_options(4, false);
  options.subdivision = 2;
  const Opened ball(ball_content(options));
  std::mt19937 random(43);
  for (int trial = 0; trial < 2000; ++trial) {
    runtime::BodyPoint at{static_cast<std::uint32_t>(random() % ball.view.meta->triangle_count), {0, 0, 0}};
    const int corner = static_cast<int>(random() % 3);
    const double share = static_cast<double>(random()) / 4294967296.0;
    at.bary[(corner + 1) % 3] = share;
    at.bary[(corner + 2) % 3] = 1 - share;
    const runtime::BodyPoint other = runtime::cross_edge(ball.view, at, corner);
    const runtime::Field here(ball.view, 0, at, {}), there(ball.view, 0, other, {});
    const Vec3 deflection = -2e-3 * here.normal() + 1e-3 * random_direction(random);
    const Vec3 a = here.force(deflection).force, b = there.force(deflection).force;
    ASSERT_LT(distance(a, b), 1e-9 * length(a));
  }
}

}  // namespace
}  // namespace palpate
