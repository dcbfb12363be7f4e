// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/pair/sample_difference.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;

// Deflections of one solve's samples on two meshes differ by the penalties' give, a few per cent.
constexpr double kSame = 0.15;

// The sample of the same kind that is nearest; null where that is another point of the path. A push sideways is far
// shorter than it is deep where friction is low: each part of the deflection is compared with its own length.
const Sample* partner(const Sample& of, const std::vector<Sample>& reference) {
  const double depth = std::abs(of.deflection.z()), sideways = of.deflection.head<2>().norm();
  const auto away = [&](const Sample& s) {
    const Vector3d d = s.deflection - of.deflection;
    const double along = std::abs(d.z()) / depth;
    return of.kind == SampleKind::normal ? along : std::max(along, d.head<2>().norm() / sideways);
  };
  const Sample* nearest = nullptr;
  for (const Sample& s : reference) {
    if (s.kind == of.kind && (nearest == nullptr || away(s) < away(*nearest))) nearest = &s;
  }
  return nearest != nullptr && away(*nearest) <= kSame ? nearest : nullptr;
}

std::vector<const Sample*> normal_samples(const std::vector<Sample>& samples) {
  std::vector<const Sample*> all;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::normal) all.push_back(&s);
  }
  return all;
}

// The force of the normal indentation from which a tangential one started.
Vector3d base_force(const std::vector<Sample>& samples, const Sample& tangential) {
  const Sample* nearest = nullptr;
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::normal) continue;
    const auto away = [&](const Sample& other) { return std::abs(other.deflection.z() - tangential.deflection.z()); };
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
    d.samples.push_back({std::size_t(&of - samples.data()), std::size_t(&other - reference.data()), difference});
    d.within_estimate += difference <= of.error_estimate + other.error_estimate;
    return difference;
  };
  const auto a = normal_samples(samples), b = normal_samples(reference);
  for (std::size_t k = 0; k < a.size(); ++k) {
    const Sample* other = partner(*a[k], reference);
    if (other == nullptr) continue;
    const auto at = std::size_t(std::find(b.begin(), b.end(), other) - b.begin());
    const Vector3d force =
        b.size() > 1 ? force_at(*other, *b[at > 0 ? at - 1 : at + 1], a[k]->deflection.z()) : other->force;
    const double difference = relative(*a[k], *other, force);
    if (2 * k >= a.size()) raise(d.normal, difference);
  }
  double depth = -1, angle = 0;
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::tangential) continue;
    const Sample* other = partner(s, reference);
    if (other == nullptr) continue;
    raise(d.tangential, relative(s, *other, other->force));
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

}  // namespace palpate::solve
