// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/layouts.hpp"

#include "precompute/algebra/rotation_between.hpp"

#include <cmath>
#include <numbers>
#include <random>

namespace palpate::verify {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kTries = 100;  // of a random place

/// Places in the frame's tangent plane (m), without the first.
std::vector<Vector2d> beside(const LayoutOptions& options) {
  const auto direction = [](double angle) { return Vector2d(std::cos(angle), std::sin(angle)); };
  std::vector<Vector2d> places;
  if (options.layout == Layout::line) {
    for (int k = 1; k < options.count; ++k) places.push_back(k * options.spacing * direction(options.angle));
  } else if (options.layout == Layout::ring) {
    const double turn = 2 * std::numbers::pi / options.count, radius = 0.5 * options.spacing / std::sin(0.5 * turn);
    for (int k = 1; k < options.count; ++k) {
      places.push_back(radius * (direction(options.angle) - direction(options.angle + k * turn)));
    }
  } else if (options.layout == Layout::random) {
    std::mt19937 random(options.seed);
    std::uniform_real_distribution<double> draw(0, 1);
    for (int tries = 0; static_cast<int>(places.size()) + 1 < options.count && tries < kTries; ++tries) {
      const double distance = options.spacing * std::pow(options.farthest / options.spacing, draw(random));
      const Vector2d at = distance * direction(2 * std::numbers::pi * draw(random));
      bool apart = true;
      for (const Vector2d& other : places) apart = apart && (at - other).norm() >= options.spacing;
      if (apart) places.push_back(at);
    }
  }
  return places;
}

}  // namespace

std::optional<Layout> layout_of(const std::string& name) {
  if (name == "line") return Layout::line;
  if (name == "ring") return Layout::ring;
  if (name == "pinch") return Layout::pinch;
  if (name == "random") return Layout::random;
  return std::nullopt;
}

Places lay_out(const Body& body, const ContactFrame& frame, const LayoutOptions& options) {
  Places places{{frame}, {}};
  const auto add = [&](const Vector3d& wanted, ContactFrame next) {
    next.origin = body.query->closest(wanted).point;
    const std::string where = std::to_string(1e3 * (wanted - frame.origin).norm()) + " mm";
    if ((next.origin - wanted).cross(frame.n).norm() > options.aside) {
      places.cause = "place: the surface bends away or ends at " + where;
    } else if (body.held(next.origin)) {
      places.cause = "place: the surface is held at " + where;
    }
    places.frames.push_back(next);
  };
  if (options.layout == Layout::pinch) {
    const std::optional<double> wall = body.query->ray(frame.origin, -frame.n, 1e-6 * body.diagonal);
    if (!wall) {
      places.cause = "place: there is no wall behind the first";
    } else {
      add(frame.origin - *wall * frame.n, {frame.origin, frame.x, -frame.y, -frame.n});
    }
  }
  for (const Vector2d& at : beside(options)) {
    if (!places.cause.empty()) break;
    add(frame.origin + at.x() * frame.x + at.y() * frame.y, frame);
    ContactFrame& next = places.frames.back();
    const Vector3d n = body.query->normal(next.origin, options.normal_radius);
    const Eigen::Quaterniond turn = algebra::rotation_between(frame.n, n);
    next.n = n;
    next.x = turn * frame.x;
    next.y = turn * frame.y;
  }
  const auto wanted = options.layout == Layout::pinch ? std::size_t{2} : static_cast<std::size_t>(options.count);
  if (places.cause.empty() && places.frames.size() < wanted) places.cause = "place: no room for so many tools";
  return places;
}

}  // namespace palpate::verify
