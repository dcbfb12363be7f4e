// SPDX-License-Identifier: MIT
#include "device/wooden_haptics/wooden_kinematics.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::device {

using runtime::Vec3;

namespace {

constexpr double kTwoPi = 6.283185307179586;

/// Turns of a body for one of its motor, with the sense.
double gear(const WoodenGeometry& g, std::size_t joint) { return g.sign[joint] * g.capstan[joint] / g.body[joint]; }

}  // namespace

const char* WoodenGeometry::validate() const {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (!std::isfinite(column) || !positive(upper) || !positive(lower)) return "the lengths of an arm are above 0";
  for (std::size_t k = 0; k < 3; ++k) {
    if (!positive(capstan[k]) || !positive(body[k])) return "the diameters of an arm are above 0";
    if (std::fabs(sign[k]) != 1) return "the sign of a joint is 1 or -1";
  }
  if (!positive(counts)) return "an encoder has counts in a turn";
  if (!positive(torque_constant)) return "a motor's torque constant is above 0";
  if (!finite(origin)) return "the origin of an arm is finite";
  return nullptr;
}

Joints angles(const WoodenGeometry& g, const Joints& counts) {
  Joints result{};
  for (std::size_t k = 0; k < 3; ++k) result[k] = kTwoPi * counts[k] / g.counts * gear(g, k);
  return result;
}

Joints counts(const WoodenGeometry& g, const Joints& angles) {
  Joints result{};
  for (std::size_t k = 0; k < 3; ++k) result[k] = angles[k] / gear(g, k) * g.counts / kTwoPi;
  return result;
}

Vec3 position(const WoodenGeometry& g, const Joints& q) {
  const double radius = g.upper * std::sin(q[1]) + g.lower * std::sin(q[2]);
  const double height = g.column + g.upper * std::cos(q[1]) - g.lower * std::cos(q[2]);
  return Vec3{std::cos(q[0]) * radius, std::sin(q[0]) * radius, height} - g.origin;
}

std::array<Vec3, 3> jacobian(const WoodenGeometry& g, const Joints& q) {
  const double ca = std::cos(q[0]), sa = std::sin(q[0]), sb = std::sin(q[1]), cb = std::cos(q[1]);
  const double sc = std::sin(q[2]), cc = std::cos(q[2]), radius = g.upper * sb + g.lower * sc;
  return {radius * Vec3{-sa, ca, 0}, g.upper * Vec3{ca * cb, sa * cb, -sb}, g.lower * Vec3{ca * cc, sa * cc, sc}};
}

bool reach(const WoodenGeometry& g, const Vec3& position, Joints& angles) {
  const Vec3 tip = position + g.origin;
  const double radius = std::hypot(tip.x, tip.y), height = tip.z - g.column;
  // In the arm's plane: two links, bent by `bend` = pi - B - C, and the direction of the tip from the upright.
  const double far = radius * radius + height * height;
  const double bent = (far - g.upper * g.upper - g.lower * g.lower) / (2 * g.upper * g.lower);
  constexpr double kRounding = 1e-12;
  if (!(std::fabs(bent) <= 1 + kRounding)) return false;
  const double bend = std::acos(std::clamp(bent, -1.0, 1.0));
  const double b =
      std::atan2(radius, height) - std::atan2(g.lower * std::sin(bend), g.upper + g.lower * std::cos(bend));
  angles = {std::atan2(tip.y, tip.x), b, kTwoPi / 2 - bend - b};
  return true;
}

Joints currents(const WoodenGeometry& g, const Joints& q, const Vec3& force) {
  const std::array<Vec3, 3> j = jacobian(g, q);
  Joints result{};
  for (std::size_t k = 0; k < 3; ++k) result[k] = dot(j[k], force) * gear(g, k) / g.torque_constant;
  return result;
}

}  // namespace palpate::device
