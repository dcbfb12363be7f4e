// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers that are the same on every machine and with every library.
#pragma once

#include "palpate/math/pose.hpp"

#include <cstdint>
#include <random>

namespace palpate::test {

class Seeded {
public:
  explicit Seeded(std::uint64_t seed) : engine_(seed) {}

  /// In [low, high).
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  /// From 0 to below `end`, above 0.
  std::uint64_t below(std::uint64_t end) { return engine_() % end; }
  std::uint8_t byte() { return static_cast<std::uint8_t>(engine_() >> 56); }
  /// Evenly in the ball of radius 1.
  runtime::Vec3 in_ball() {
    for (;;) {
      const runtime::Vec3 v{between(-1, 1), between(-1, 1), between(-1, 1)};
      if (dot(v, v) <= 1) return v;
    }
  }

private:
  std::mt19937_64 engine_;
};

}  // namespace palpate::test
