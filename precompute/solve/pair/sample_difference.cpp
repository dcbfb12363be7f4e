// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/pair/sample_difference.hpp"

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

Vector3d force_at(const Sample& here, const Sample& neighbour, double depth) {
  const double run = std::log(neighbour.deflection.z() / here.deflection.z());
  const double rise = std::log(neighbour.force.norm() / here.force.norm());
  return here.force * std::pow(depth / here.deflection.z(), rise / run);
}

SampleDifference sample_difference(const std::vector<Sample>& samples, const std::vector<Sample>& reference) {
  SampleDifference d;
  // Unlike std::max, keeps a NaN: what cannot be compared must not look alike.
  const auto raise = [](double& to, double value) { to = value <= to ? to : value; };
  const auto relative = [&](const Sample& of, const Sample& other, const Vector3d& force) {
    const double difference = (of.force - force).norm() / force.norm();
    ++d.compared;
    d.foretold += difference <= of.error_estimate + other.error_estimate;
    return difference;
  };
  const auto a = straight(samples), b = straight(reference);
  const std::size_t count = std::min(a.size(), b.size());
  for (std::size_t k = 0; k < count; ++k) {
    const Sample& other = *b[k];
    const Vector3d force =
        b.size() > 1 ? force_at(other, *b[k + 1 < b.size() ? k + 1 : k - 1], a[k]->deflection.z()) : other.force;
    const double difference = relative(*a[k], other, force);
    if (2 * k < count) raise(d.straight, difference);
  }
  double depth = -1, angle = 0;
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::tangential) continue;
    const auto same = [&](const Sample& r) { return r.kind == s.kind && r.index == s.index; };
    const auto other = std::find_if(reference.begin(), reference.end(), same);
    if (other == reference.end()) continue;
    raise(d.sideways, relative(s, *other, other->force));
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
