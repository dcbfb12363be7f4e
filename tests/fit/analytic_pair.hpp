// SPDX-License-Identifier: GPL-3.0-or-later
// Samples of pairs with known answers: a power law in depth, a tangential response that is an exact product.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "formats/journal/samples.hpp"

namespace palpate::test {

/// A pair whose force is known everywhere.
struct AnalyticPair {
  std::function<Eigen::Vector3d(double)> push;                        ///< normal indentation force (x, y, n) at a depth
  std::function<double(double)> growth = [](double) { return 0.0; };  ///< of the tangential response with depth
  std::function<double(double)> tangential_x = [](double) { return 0.0; },
                                tangential_y = tangential_x;  ///< at growth 1
  double friction = 0.0;

  [[nodiscard]] Eigen::Vector3d force(const Eigen::Vector3d& deflection) const {
    const double g = growth(deflection.z());
    return push(deflection.z()) +
           Eigen::Vector3d(g * tangential_x(deflection.x()), g * tangential_y(deflection.y()), 0);
  }
};

/// The bake's path: `points` depths even in sqrt(depth) up to `depth`; tangential pushes at `levels` of them.
inline std::vector<Sample> samples_of(const AnalyticPair& pair, double depth, int points = 12, int levels = 2,
                                      int directions = 4, double reach = 0.4) {
  std::vector<Sample> samples;
  for (int k = 1; k <= points; ++k) {
    Sample s;
    s.index = static_cast<std::uint16_t>(k - 1);
    s.deflection = {0, 0, depth * k * k / (points * points)};
    s.force = pair.push(s.deflection.z());
    s.friction_limit = pair.friction;
    samples.push_back(s);
  }
  std::uint16_t index = 0;
  for (int level = 1; level <= levels && pair.friction > 0; ++level) {
    const double z = samples[static_cast<std::size_t>(points * level / levels - 1)].deflection.z();
    for (int d = 0; d < directions; ++d) {
      const double angle = 2 * std::numbers::pi * d / directions;
      for (int k = 1; k <= 3; ++k) {
        Sample s;
        s.kind = SampleKind::tangential;
        s.index = index++;
        const double r = reach * z * k / 3;
        s.deflection = {r * std::cos(angle), r * std::sin(angle), z};
        s.force = pair.force(s.deflection);
        samples.push_back(s);
      }
    }
  }
  return samples;
}

/// F = stiffness z^power along n.
inline AnalyticPair power_law(double stiffness, double power) {
  AnalyticPair pair;
  pair.push = [=](double z) { return Eigen::Vector3d(0, 0, stiffness * std::pow(z, power)); };
  return pair;
}

}  // namespace palpate::test
