// SPDX-License-Identifier: GPL-3.0-or-later
// An opened sample file that owns its bytes, and Eigen-free vector helpers for the runtime's tests.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "palpate/palpate.hpp"
#include "tests/support/response_samples.hpp"

namespace palpate::test {

using runtime::Pose;
using runtime::State;
using runtime::Tick;
using runtime::Vec3;
using Options = ResponseSampleOptions;

struct Opened {
  ResponseFileContent content;
  std::vector<std::byte> bytes;
  runtime::View view;
  explicit Opened(ResponseFileContent c) : content(std::move(c)), bytes(encode(content)) {
    const runtime::OpenResult result = runtime::View::open(bytes.data(), bytes.size());
    EXPECT_TRUE(result) << result.error;
    view = result.view;
  }
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;
};

inline Options uniform() {
  Options options;
  options.uniform = true;
  return options;
}

inline Pose upright(const Vec3& at) { return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, at}; }

inline double distance(const Vec3& a, const Vec3& b) { return length(a - b); }

/// Depth law of the uniform samples (N).
inline double hertz(double z) {
  const double s = std::sqrt(z / kDepthScale);
  return kHertzForce * (0.9 * s * s * s + 0.1 * s * s);
}

/// Height of the box's top over the origin (m).
inline constexpr double kTop = kBoxSize / 4;

/// Turned by an angle (rad) about a unit axis through the origin.
inline Pose turned(double angle, const Vec3& axis, const Vec3& translation) {
  return Pose::from_quaternion(std::cos(angle / 2), std::sin(angle / 2) * axis.x, std::sin(angle / 2) * axis.y,
                               std::sin(angle / 2) * axis.z, translation);
}

/// A tip on the box at a time (s): down, aside until it slides, back, up.
inline Pose probing(double t) {
  const double depth = 0.003 * std::sin(2 * t), aside = 0.004 * std::sin(5 * t);
  return upright({aside, 0.3 * aside, kTop + kTipRadius - depth});
}

/// Tip centre (m) at a depth in the top of the box.
inline Vec3 centre(double depth, double x = 0, double y = 0) { return {x, y, kTop + kTipRadius - depth}; }

/// A box with one response everywhere, whose normal indentations have no tangential force.
inline Options flat(bool friction = true) {
  Options options = uniform();
  options.bias = false;
  options.friction = friction;
  return options;
}

/// Moves a contact in a straight line in steps of at most `step` (m) and calls see(pose, tick) for every tick.
template <class Contact, class See>
void move(Contact& contact, const Vec3& from, const Vec3& to, double step, const See& see) {
  const int steps = static_cast<int>(std::ceil(length(to - from) / step));
  for (int i = 1; i <= steps; ++i) {
    const Pose pose = upright(from + (i / static_cast<double>(steps)) * (to - from));
    see(pose, contact.tick(pose));
  }
}
/// Returns the last tick.
template <class Contact>
Tick move(Contact& contact, const Vec3& from, const Vec3& to, double step = 2e-5) {
  Tick last;
  move(contact, from, to, step, [&](const Pose&, const Tick& tick) { last = tick; });
  return last;
}

inline Vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return unit(Vec3{normal(random), normal(random), normal(random)}, {0, 0, 1});
}

/// The same point of an edge as a point of the triangle across it.
inline runtime::BodyPoint across_edge(const runtime::View& view, const runtime::BodyPoint& at, int corner) {
  const layout::SurfaceTriangle here = view.triangle(at.triangle);
  runtime::BodyPoint there{here.neighbour[corner], {0, 0, 0}};
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      if (view.triangle(there.triangle).vertex[j] == here.vertex[k] && k != corner) there.bary[j] = at.bary[k];
    }
  }
  return there;
}

}  // namespace palpate::test
