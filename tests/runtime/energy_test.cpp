// SPDX-License-Identifier: GPL-3.0-or-later
// What a contact of a separable file gives back, whose sideways forces are no gradient: never more than it took.
#include <cmath>
#include <numbers>

#include "tests/runtime/support.hpp"

namespace palpate::test {
namespace {

using runtime::Contact;
using runtime::EnergyMeter;

/// A ball whose every pose and tick is counted.
struct Counted {
  Contact contact;
  EnergyMeter meter;
  explicit Counted(const runtime::View& view) : contact(view, 0) {}

  Tick go(const Vec3& at) {
    const Pose pose = upright(at);
    const Tick tick = contact.tick(pose);
    meter.add(pose, tick);
    return tick;
  }
  /// In a straight line, so far a tick (m).
  void draw(const Vec3& from, const Vec3& to, double stride) {
    const int ticks = static_cast<int>(length(to - from) / stride) + 1;
    for (int k = 1; k <= ticks; ++k) go(from + (static_cast<double>(k) / ticks) * (to - from));
  }
  [[nodiscard]] double net() const { return meter.given() - meter.returned(); }
};

// Aside while it is shallow, back while it is deep, or the other way round: one of them takes less than it gives back.
TEST(Energy, NoClosedWayOfAToolThatSticksIsAMotor) {
  const Opened box(box_content({}));
  constexpr int kLoops = 300, kTicks = 200;
  for (std::uint32_t site = 0; site < 8; ++site) {
    const Vec3 n = runtime::to_vec(box.view.sites[site].normal), c = runtime::to_vec(box.view.sites[site].position);
    const Vec3 x = runtime::any_orthogonal(n), y = cross(n, x);
    for (const double angle : {0.0, 0.25 * std::numbers::pi, 0.5 * std::numbers::pi, 0.75 * std::numbers::pi}) {
      for (const double hand : {-1e-4, 1e-4}) {
        Counted ball(box.view);
        const auto at = [&](double aside, double depth) {
          return c + (kTipRadius - depth) * n + aside * (std::cos(angle) * x + std::sin(angle) * y) + 1e-4 * x;
        };
        ball.draw(at(0, -1e-4), at(0, 0.3 * kDepthScale), 5e-6);
        const double pressed = ball.net();
        for (int k = 0; k < kLoops * kTicks; ++k) {
          const double phase = 2 * std::numbers::pi * (k + 1) / kTicks;
          const Tick tick = ball.go(at(hand * std::sin(phase), kDepthScale * (0.5 - 0.2 * std::cos(phase))));
          ASSERT_TRUE(tick.touches());
          ASSERT_GT(ball.net(), -1e-3 * pressed) << site << ' ' << angle << ", loop " << k / kTicks;
        }
        ball.draw(at(0, 0.3 * kDepthScale), at(0, -1e-4), 5e-6);
        EXPECT_GT(ball.net(), -1e-3 * pressed) << site << ' ' << angle;
      }
    }
  }
}

// Pressed from any side, drawn over edges onto faces that are harder, and lifted.
TEST(Energy, NoStrokeGivesBackMoreThanItTook) {
  const Opened box(box_content({}));
  std::mt19937 random(5);
  const auto share = [&] { return static_cast<double>(random()) / 4294967296.0; };
  int touched = 0;
  for (int stroke = 0; stroke < 400; ++stroke) {
    Counted ball(box.view);
    const auto touch = [&](const Vec3& from) { return runtime::find_touch(box.view, 0, upright(from)); };
    // A place in the air, the nearest of the body, and one within reach of it.
    const Vec3 air = 0.06 * random_direction(random), down = unit(touch(air).body.point - air, {0, 0, -1});
    const Vec3 on = air + (touch(air).clearance + (0.2 + 0.4 * share()) * kDepthScale) * down;
    const Vec3 along = unit(cross(down, random_direction(random)), {1, 0, 0});
    const Vec3 to = on + (0.01 + 0.02 * share()) * along - 0.002 * share() * down, out = to - 0.05 * down;
    ball.go(air);
    ball.draw(air, on, 2e-5);
    const double pressed = ball.meter.given();
    ball.draw(on, to, 2e-5);
    ball.draw(to, out, 2e-5);
    touched += pressed > 0;
    EXPECT_GE(ball.net(), -0.01 * ball.meter.given()) << stroke;
  }
  EXPECT_GT(touched, 350);
}

}  // namespace
}  // namespace palpate::test
