// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/sample_difference.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using Eigen::Vector3d;

// Straight pushes, the deepest first.
std::vector<const Sample*> straight(const std::vector<Sample>& samples) {
  std::vector<const Sample*> all;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::normal) all.push_back(&s);
  }
  std::reverse(all.begin(), all.end());
  return all;
}

// The force of the straight push from which a sideways one started.
Vector3d base_force(const std::vector<Sample>& samples, const Sample& sideways) {
  const Sample* nearest = nullptr;
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::normal) continue;
    const auto away = [&](const Sample& other) { return std::abs(other.deflection.z() - sideways.deflection.z()); };
    if (nearest == nullptr || away(s) < away(*nearest)) nearest = &s;
  }
  return nearest != nullptr ? nearest->force : Vector3d::Zero();
}

// N/m, against the deflection.
double secant(const std::vector<Sample>& samples, const Sample& s) {
  const Vector3d along(s.deflection.x(), s.deflection.y(), 0);
  return -(s.force - base_force(samples, s)).dot(along) / along.squaredNorm();
}

}  // namespace

SampleDifference sample_difference(const std::vector<Sample>& samples, const std::vector<Sample>& reference) {
  SampleDifference d;
  // Unlike std::max, keeps a NaN: what cannot be compared must not look alike.
  const auto raise = [](double& to, double value) { to = value <= to ? to : value; };
  const auto relative = [&](const Sample& a, const Sample& b) {
    ++d.compared;
    return (a.force - b.force).norm() / b.force.norm();
  };
  const auto a = straight(samples), b = straight(reference);
  for (std::size_t k = 0; 2 * k < std::min(a.size(), b.size()); ++k) {
    raise(d.straight, relative(*a[k], *b[k]));
  }
  double depth = -1, angle = 0;
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::tangential) continue;
    const auto same = [&](const Sample& r) { return r.kind == s.kind && r.index == s.index; };
    const auto other = std::find_if(reference.begin(), reference.end(), same);
    if (other == reference.end()) continue;
    raise(d.sideways, relative(s, *other));
    const double turned = std::atan2(s.deflection.y(), s.deflection.x());
    const bool first = s.deflection.z() != depth || std::abs(turned - angle) > 1e-3;
    depth = s.deflection.z();
    angle = turned;
    if (first) {
      raise(d.stiffness, std::abs(secant(samples, s) / secant(reference, *other) - 1));
    }
  }
  return d;
}

}  // namespace palpate
