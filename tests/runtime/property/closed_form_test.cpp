// SPDX-License-Identifier: GPL-3.0-or-later
// A contact on an analytic Hertz block against Mindlin, Cattaneo and Mindlin, and Masing; tremor of a loaded contact.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/runtime/support.hpp"

namespace palpate::closed_form_test {
namespace {

using namespace test;
using runtime::Contact;

constexpr double kFriction = 0.3, kMostError = 0.03;
constexpr double kDepths[] = {0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0, 1.15, 1.3};  // Z

/// F grows like z^1.5 and K like z^0.5, as of a ball on a half-space: K is 0.8 times dF/dz, as at a Poisson's ratio of 1/3.
ResponseFileContent hertz_block() {
  ResponseFileContent content = box_content(flat());
  content.degrees = response::Degrees{3, 0, 2, 0, true};
  const response::Offsets o = response::offsets(content.degrees);
  const double unit = kHertzForce / 1e4;
  // K X = integral of K' ds: K(Z) = 0.8 * 1.5 F(Z) / Z.
  const double stiffness = 0.8 * 1.5 * kHertzForce / kDepthScale * kTangentialScale;
  for (Response& r : content.responses) {
    r.unit = static_cast<float>(unit);
    r.coefficients.assign(static_cast<std::size_t>(o.end), 0);
    r.coefficients[1] = 10000;
    for (int k = o.stiffness; k < o.coupling; k += 3) {
      r.coefficients[static_cast<std::size_t>(k)] = static_cast<std::int16_t>(std::lround(stiffness / unit));
    }
    for (int k = o.friction; k < o.end; ++k) {
      r.coefficients[static_cast<std::size_t>(k)] = static_cast<std::int16_t>(std::lround(kFriction / layout::kFrictionUnit));
    }
  }
  return content;
}

/// Force over the limit at a deflection from rest: T / (mu F) = 1 - (1 - 2 K x / (3 mu F))^1.5.
double cattaneo_mindlin(double x, double stiffness, double limit) {
  const double left = 1 - 2 * stiffness * x / (3 * limit);
  return left > 0 ? 1 - std::pow(left, 1.5) : 1;
}

/// A contact that is pressed to a depth and drawn along x.
struct Drawn {
  explicit Drawn(const runtime::View& view, double depth) : contact(view, 0), at(depth) {
    move(contact, centre(-1e-4), centre(depth), 2e-6);
    const auto r = contact.response().law().at(depth);
    stiffness = r.stiffness.m;
    limit = r.friction_coefficient * r.normal_force;
    reach = 1.5 * limit / stiffness;
  }
  /// Share of the limit after a draw to x (m).
  double to(double x) {
    const int steps = 1 + static_cast<int>(std::fabs(x - now) / (reach / 400));
    Tick tick;
    for (int k = 1; k <= steps; ++k) tick = contact.tick(upright(centre(at, now + (x - now) * k / steps)));
    now = x;
    state = tick.state;
    return -tick.force.x / limit;
  }
  Contact contact;
  double at, now = 0, stiffness = 0, limit = 0, reach = 0;
  State state = State::free;
};

TEST(ClosedForm, FirstStiffnessIsMindlins) {
  const Opened block(hertz_block());
  for (const double depth : kDepths) {
    Drawn drawn(block.view, depth * kDepthScale);
    const double x = 1e-4 * drawn.reach;
    EXPECT_NEAR(drawn.to(x) * drawn.limit / x, drawn.stiffness, kMostError * drawn.stiffness) << depth;
  }
}

TEST(ClosedForm, PartialSlipIsThatOfCattaneoAndMindlin) {
  const Opened block(hertz_block());
  double worst = 0;
  for (const double depth : kDepths) {
    Drawn drawn(block.view, depth * kDepthScale);
    for (double share = 0.02; share < 1.3; share += 0.02) {
      const double x = share * drawn.reach, expected = cattaneo_mindlin(x, drawn.stiffness, drawn.limit);
      const double error = std::fabs(drawn.to(x) - expected);
      EXPECT_LT(error, kMostError) << depth << ' ' << share;
      worst = std::max(worst, error);
    }
    EXPECT_EQ(drawn.state, State::slide) << depth;
  }
  RecordProperty("worst_of_limit", std::to_string(worst));
}

TEST(ClosedForm, UnloadingAndReloadingFollowMasing) {
  const Opened block(hertz_block());
  double worst = 0;
  for (const double depth : kDepths) {
    for (const double turn : {0.4, 0.8}) {
      Drawn drawn(block.view, depth * kDepthScale);
      const double top = turn * drawn.reach, first = drawn.to(top);
      const auto expect = [&](double from, double at_from, double to, double sign) {
        for (int k = 1; k <= 20; ++k) {
          const double x = from + (to - from) * k / 20;
          const double branch = 2 * cattaneo_mindlin(std::fabs(x - from) / 2, drawn.stiffness, drawn.limit);
          // Relative to the loop's span, which is twice the limit.
          const double error = std::fabs(drawn.to(x) - (at_from + sign * branch)) / 2;
          EXPECT_LT(error, kMostError) << depth << ' ' << turn << ' ' << x / drawn.reach;
          worst = std::max(worst, error);
        }
      };
      expect(top, first, -top, -1);
      const double bottom = drawn.to(-top);
      EXPECT_NEAR(bottom, -first, 0.01) << "the loop is symmetric";
      expect(-top, bottom, top, 1);
      EXPECT_NEAR(drawn.to(top), first, 0.01) << "the loop closes";
    }
  }
  RecordProperty("worst_of_span", std::to_string(worst));
}

TEST(ClosedForm, TremorOfTheDepthKeepsTheTangentialForce) {
  const Opened block(hertz_block()), sample(box_content(flat()));
  for (const Opened* file : {&block, &sample}) {
    const double depth = 0.5 * kDepthScale, amplitude = 0.04 * kDepthScale;
    Drawn drawn(file->view, depth);
    double x = 0;
    while (drawn.to(x) < 0.5) x += drawn.reach / 400;
    const double first = drawn.to(x);
    Tick tick;
    for (int k = 1; k <= 20000; ++k) {
      tick = drawn.contact.tick(upright(centre(depth + amplitude * std::sin(2 * std::numbers::pi * 0.01 * k), x)));
    }
    EXPECT_GT(-tick.force.x / drawn.limit, 0.9 * first);
    EXPECT_LT(-tick.force.x / drawn.limit, 1.001 * first);
  }
}

}  // namespace
}  // namespace palpate::closed_form_test
