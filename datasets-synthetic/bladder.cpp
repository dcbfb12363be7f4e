// SPDX-License-Identifier: GPL-3.0-or-later
// Two ellipsoids, the inner one facing inward.
#include "datasets-synthetic/bladder.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/solids.hpp"

#include <cmath>
#include <string>
#include <utility>

namespace palpate::synth {
namespace {

const Eigen::Vector3d kOutside(0.035, 0.032, 0.04);  // m, semi-axes
constexpr double kWall = 0.004;                      // m

}  // namespace

Surface BladderShape::surface(double edge) const {
  Surface both = geometry::ellipsoid({0, 0, 0}, scale_ * kOutside, edge, "bladder");
  const Surface lumen =
      geometry::ellipsoid({0, 0, 0}, scale_ * (kOutside - Eigen::Vector3d::Constant(kWall)), edge, "lumen");
  const auto first = static_cast<std::int32_t>(both.vertices.size());
  both.vertices.insert(both.vertices.end(), lumen.vertices.begin(), lumen.vertices.end());
  for (const auto& [a, b, c] : lumen.triangles) both.triangles.push_back({a + first, c + first, b + first});
  both.parts.resize(both.triangles.size(), 1);
  both.part_names.push_back(lumen.part_names[0]);
  return both;
}

double BladderShape::neck() const { return -0.85 * scale_ * kOutside.z(); }

double BladderShape::rise(double young, double pressure) const {
  // p = 2 mu t / r (1 / l - 1 / l^7), largest at l = 7^(1/6); the stretch before that by bisection.
  const double radius = std::cbrt(kOutside.prod()) - kWall / 2;
  const double unit = 2 * young / 3 * kWall / radius;
  const auto held = [&](double l) { return unit * (1 / l - std::pow(l, -7)); };
  double low = 1, high = std::pow(7, 1.0 / 6);
  if (!(pressure < held(high))) {
    throw Error(ExitCode::usage, "pressure: got " + std::to_string(pressure) +
                                     " Pa; a wall of that modulus holds up to about " + std::to_string(held(high)));
  }
  for (int k = 0; k < 50; ++k) {
    const double middle = (low + high) / 2;
    (held(middle) < pressure ? low : high) = middle;
  }
  return (low - 1) * scale_ * 2 * kOutside.z();  // the neck stays
}

}  // namespace palpate::synth
