// SPDX-License-Identifier: GPL-3.0-or-later
// A motion that every machine makes alike.
#pragma once

#include <cstdint>

#include "palpate/math/pose.hpp"

namespace palpate::test {

/// A smooth wandering about the top of the box of response_samples.hpp, into it and out again, fast (0.04 m/s and 1
/// rad/s at a thousand ticks a second) and slow by turns. Neither library nor compiler can change it by more than
/// rounding.
class Wandering {
public:
  explicit Wandering(std::uint32_t seed) : random_(seed) {}
  runtime::Pose next() {
    const double pace = ticks_++ % 200 < 100 ? 1 : 0.02;
    velocity_ = velocity_ + pace * (4e-6 * normal() - 5e-3 * velocity_ - pull(at_ - kMiddle));
    at_ = at_ + pace * velocity_;
    spin_ = spin_ + pace * (1e-4 * normal() - 5e-3 * spin_ - 2e-5 * turn_);
    turn_ = turn_ + pace * spin_;
    return runtime::Pose::from_quaternion(1, turn_.x, turn_.y, turn_.z, at_);
  }

private:
  static constexpr runtime::Vec3 kMiddle{0, 0, 0.0185};

  // Harder upwards and downwards: it touches and leaves the top every few tenths of a second.
  static runtime::Vec3 pull(const runtime::Vec3& off) { return {2e-5 * off.x, 2e-5 * off.y, 4e-4 * off.z}; }

  double uniform() {
    random_ = 1664525u * random_ + 1013904223u;
    return (random_ >> 8) / 16777216.0 - 0.5;
  }
  double bell() { return 1.7 * (uniform() + uniform() + uniform() + uniform()); }
  runtime::Vec3 normal() {
    const double x = bell(), y = bell();
    return {x, y, bell()};
  }

  std::uint32_t random_, ticks_ = 0;
  runtime::Vec3 at_{0, 0, 0.025}, velocity_, spin_, turn_;
};

}  // namespace palpate::test
