// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/play/closed_motions.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace palpate::cli {
namespace {

using runtime::Pose;
using runtime::Vec3;
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

// Large and tiny ones, deepening and lifting under tangential load, reversals.
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

/// A tool over a place of the body, with its axis along the normal.
struct MotionPlace {
  std::uint32_t tool = 0;
  Pose touching;  ///< where the skin just touches
  Vec3 normal, x, y;
};

MotionPlace random_place(const runtime::View& view, Draws& draw) {
  MotionPlace place;
  place.tool = draw.below(view.meta->tool_count);
  const double a = draw(0, 1), b = draw(0, 1 - a);
  const runtime::BodyPoint at{draw.below(view.meta->triangle_count), {a, b, 1 - a - b}};
  place.normal = smooth_normal(view, at);
  place.x = runtime::any_orthogonal(place.normal);
  place.y = cross(place.normal, place.x);
  const Vec3 c = position(view, at);
  place.touching = Pose::from_axis(c, place.normal);
  // The clearance changes by no more than the way: a few steps bring the skin to the body.
  for (int k = 0; k < 20; ++k) {
    const double clearance = runtime::search(view, place.tool, place.touching).touch.clearance;
    place.touching.translation = place.touching.translation - clearance * place.normal;
  }
  return place;
}

// m. Deeper than the depth scale a response goes on linearly.
double depth_of(const MotionLeg& leg, double scale) { return (leg.t < 1 ? leg.t * leg.t : 2 * leg.t - 1) * scale; }

/// Work of the hand over its gross work, along the legs and back out. The work of a step is the mean of its two forces
/// times the step; steps are a two-hundredth of the deepest indentation, so that this is the work of the way.
double share(const runtime::View& view, const MotionPlace& place, const Legs& legs) {
  runtime::Contact contact(view, place.tool);
  const double z = view.meta->depth_scale;
  double deepest = 0;
  for (const MotionLeg& leg : legs) deepest = std::max(deepest, depth_of(leg, z));
  const double step = 0.005 * std::min(deepest, z), clear = 0.05 * deepest;
  Vec3 at{0, 0, clear}, force;  // m, the last is the height
  bool touching = false;
  double work = 0, gross = 0;
  const auto tick = [&](const Vec3& to) {
    Pose pose = place.touching;
    pose.translation = pose.translation + to.x * place.x + to.y * place.y + to.z * place.normal;
    const runtime::Tick answer = contact.tick(pose);
    touching = answer.touches();
    const Vec3 now = answer.force, way = to - at, mean = 0.5 * (force + now);
    const double w = -(way.x * dot(mean, place.x) + way.y * dot(mean, place.y) + way.z * dot(mean, place.normal));
    work += w;
    gross += std::abs(w);
    at = to;
    force = now;
  };
  const auto go = [&](const Vec3& to) {
    const Vec3 from = at;
    const int steps = std::max(1, static_cast<int>(length(to - from) / step));
    for (int k = 1; k <= steps; ++k) tick(from + (static_cast<double>(k) / steps) * (to - from));
  };
  for (const MotionLeg& leg : legs) {
    go({leg.x * z, leg.y * z, at.z});
    go({leg.x * z, leg.y * z, -depth_of(leg, z)});
  }
  do go({at.x, at.y, at.z + deepest});
  while (touching && at.z < 10 * z);
  if (!std::isfinite(gross)) return -HUGE_VAL;  // a NaN must not pass for nothing given back
  return gross > 0 ? work / gross : 0;
}

// Legs a little changed, while that lessens the work.
double descend(const runtime::View& view, const MotionPlace& place, Legs legs, Draws& draw) {
  constexpr int kTries = 60;
  double least = share(view, place, legs), step = 0.3;
  for (int k = 0; k < kTries; ++k) {
    Legs other = legs;
    for (MotionLeg& leg : other) {
      leg.x += step * draw(-1, 1) * (std::abs(leg.x) + 0.01);
      leg.y += step * draw(-1, 1) * (std::abs(leg.y) + 0.01);
      leg.t = std::clamp(leg.t + step * draw(-0.2, 0.2), 0.02, 1.2);
    }
    const double there = share(view, place, other);
    if (there < least) {
      least = there;
      legs = std::move(other);
    } else {
      step = std::max(0.9 * step, 1e-3);
    }
  }
  return least;
}

}  // namespace

ClosedMotionsReport play_closed_motions(const runtime::View& view, const ClosedMotionsOptions& options) {
  constexpr std::uint64_t kAtOnePlace = 20;
  Draws draw(options.seed);
  ClosedMotionsReport report;
  const auto tell = [&](const char* what, std::uint64_t done, std::uint64_t total) {
    if (options.progress && done % std::max<std::uint64_t>(1, total / 10) == 0) options.progress(what, done, total);
  };
  while (report.motions < options.motions) {
    const MotionPlace place = random_place(view, draw);
    for (std::uint64_t k = 0; k < kAtOnePlace && report.motions < options.motions; ++k, ++report.motions) {
      report.worst = std::min(report.worst, share(view, place, random_legs(draw)));
      tell("closed motions", report.motions + 1, options.motions);
    }
  }
  for (int k = 0; k < options.searches; ++k) {
    const MotionPlace place = random_place(view, draw);
    report.searched = std::min(report.searched, descend(view, place, random_legs(draw), draw));
    tell("searches", static_cast<std::uint64_t>(k) + 1, static_cast<std::uint64_t>(options.searches));
  }
  return report;
}

}  // namespace palpate::cli
