// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/closed_motions.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "formats/error.hpp"
#include "tools/closed_motion.hpp"

namespace palpate::cli {
namespace {

using coupled::Vec2;
using Legs = std::vector<MotionLeg>;

class Draws {
public:
  explicit Draws(std::uint64_t seed) : random_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1.0p-53;
  }
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }

private:
  std::mt19937_64 random_;
};

// Large and tiny ones, deepening and lifting under side load, reversals.
Legs random_legs(Draws& draw) {
  const double size = std::pow(10.0, draw(-3, 0));
  Legs legs{{0, 0, draw(0.05, 0.8)}};
  const std::uint32_t more = 2 + draw.below(3);
  for (std::uint32_t k = 0; k < more; ++k) {
    const double r = size * std::sqrt(draw(0, 1)), a = draw(0, 6.283185307179586);
    legs.push_back({r * std::cos(a), r * std::sin(a), std::clamp(legs.back().t + draw(-0.2, 0.2) * size, 0.02, 1.2)});
  }
  return legs;
}

ClosedMotion played(const coupled::Law& law, const layout::Meta& m, const Legs& legs) {
  ClosedMotion motion(law, m.depth_scale, m.sideways_scale, 0.0025);
  for (const MotionLeg& leg : legs) {
    motion.sideways({leg.x, leg.y});
    motion.depth(leg.t);
  }
  motion.depth(0);
  return motion;
}

// What is no number must not pass for nothing given back.
double share(const ClosedMotion& motion) {
  if (!std::isfinite(motion.gross())) return -HUGE_VAL;
  return motion.gross() > 0 ? motion.work() / motion.gross() : 0;
}

// Legs a little changed, while that takes work from the body.
double descend(const coupled::Law& law, const layout::Meta& m, Legs legs, Draws& draw) {
  constexpr int kTries = 60;
  double least = share(played(law, m, legs)), step = 0.3;
  for (int k = 0; k < kTries; ++k) {
    Legs other = legs;
    for (MotionLeg& leg : other) {
      leg.x += step * draw(-1, 1) * (std::abs(leg.x) + 0.01);
      leg.y += step * draw(-1, 1) * (std::abs(leg.y) + 0.01);
      leg.t = std::clamp(leg.t + step * draw(-0.2, 0.2), 0.02, 1.2);
    }
    const double there = share(played(law, m, other));
    if (there < least) {
      least = there;
      legs = std::move(other);
    } else {
      step = std::max(0.9 * step, 1e-3);
    }
  }
  return least;
}

runtime::Field random_field(const runtime::View& view, Draws& draw) {
  const std::uint32_t tool = draw.below(view.meta->tool_count);
  const layout::ToolRecord& record = view.tools[tool];
  runtime::BodyPoint body{draw.below(view.meta->triangle_count), {}};
  runtime::ToolPoint point{record.patch_count > 0 ? record.first_patch + draw.below(record.patch_count) : 0, {}};
  for (auto* weights : {&body.bary, &point.weights}) {
    const double a = draw(0, 1), b = draw(0, 1 - a);
    (*weights)[0] = a, (*weights)[1] = b, (*weights)[2] = 1 - a - b;
  }
  if (record.patch_count == 0) point.weights[0] = 1, point.weights[1] = point.weights[2] = 0;
  return {view, tool, body, point};
}

}  // namespace

ClosedMotionsReport play_closed_motions(const runtime::View& view, const ClosedMotionsOptions& options) {
  if (!layout::is_coupled(*view.meta)) {
    throw Error(ExitCode::bad_input,
                "the separable model gives no more back than it takes at one depth only: closed motions are played on "
                "files of the coupled model or a spring");
  }
  constexpr std::uint64_t kOnOneField = 20;
  Draws draw(options.seed);
  ClosedMotionsReport report;
  while (report.motions < options.motions) {
    const runtime::Field field = random_field(view, draw);
    for (std::uint64_t k = 0; k < kOnOneField && report.motions < options.motions; ++k, ++report.motions) {
      const ClosedMotion motion = played(field.law(), *view.meta, random_legs(draw));
      report.worst = std::min(report.worst, share(motion));
    }
  }
  for (int k = 0; k < options.searches; ++k) {
    const runtime::Field field = random_field(view, draw);
    report.searched = std::min(report.searched, descend(field.law(), *view.meta, random_legs(draw), draw));
  }
  return report;
}

}  // namespace palpate::cli
