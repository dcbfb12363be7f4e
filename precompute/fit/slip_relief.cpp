// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/slip_relief.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "palpate/relief.hpp"

namespace palpate::fit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Of a slipping push: what has slipped (m), how much of the relief came of it, and by how much of it the normal force
// is less than that of a contact which sticks with as much sideways force.
struct Shortfall {
  Vector2d way;
  double reached, missing;
};

// How far a contact that sticks goes along the unit u for a sideways force (N) beyond the straight push's: at most as
// far as `most` (m).
double held_deflection(double wanted, double depth, const Vector2d& u, double most, const StickingForce& sticking) {
  const auto pull = [&](double way) {
    return -(sticking({way * u.x(), way * u.y(), depth}) - sticking({0, 0, depth})).head<2>().dot(u);
  };
  double low = 0, high = most;
  if (pull(high) < wanted) return high;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (pull(middle) < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Shortfall shortfall(const Sample& s, const Sample& straight, const StickingForce& sticking) {
  const double depth = s.deflection.z(), moved = s.deflection.head<2>().norm();
  const Vector2d u = s.deflection.head<2>() / moved;
  const double pull = -(s.force - straight.force).head<2>().dot(u),
               limit = straight.friction_limit * straight.force.z();
  const double held = held_deflection(pull, depth, u, moved, sticking);
  const double most = std::max(held_deflection(limit, depth, u, 2 * moved, sticking), 1e-6 * depth);
  const double sticks = sticking({held * u.x(), held * u.y(), depth}).z();
  return {(moved - held) * u, 1 - std::exp((held - moved) / (runtime::kReliefReach * most)), 1 - s.force.z() / sticks};
}

// What would be missing at one depth of a contact that slipped, but went nowhere; nothing where they do not tell.
std::optional<double> without_way(const std::vector<Shortfall>& all, double depth) {
  constexpr Eigen::Index kUnknowns = 4;
  // At a margin the tool slides off what it pressed: no square of the way says how much less it pushes there.
  constexpr double kMostMissing = 0.25;
  for (const Shortfall& one : all) {
    if (std::abs(one.missing) > kMostMissing) return std::nullopt;
  }
  const auto count = static_cast<Eigen::Index>(all.size());
  if (count < kUnknowns) return std::nullopt;
  Eigen::MatrixXd rows(count, kUnknowns);
  Eigen::VectorXd target(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Shortfall& one = all[static_cast<std::size_t>(i)];
    const Vector2d way = one.way / depth;
    rows.row(i) << one.reached, way.x(), way.y(), way.squaredNorm();
    target[i] = one.missing;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(rows);
  if (solver.rank() < kUnknowns) return std::nullopt;
  const double missing = solver.solve(target)[0];
  if (std::abs(missing) > kMostMissing) return std::nullopt;
  return missing;
}

}  // namespace

double slip_relief(const std::vector<Sample>& samples, const StickingForce& sticking, double scale) {
  std::map<double, std::vector<Shortfall>> by_depth;  // of straight and slipping pushes that is the same, bit by bit
  std::map<double, const Sample*> straight;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::normal) straight[s.deflection.z()] = &s;
  }
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::slipping) continue;
    const auto from = straight.find(s.deflection.z());
    if (from == straight.end() || !(from->second->friction_limit > 0)) continue;
    by_depth[s.deflection.z()].push_back(shortfall(s, *from->second, sticking));
  }
  // Of a force that grows like depth^p the share (p + 2) k z / Z is missing.
  double sum = 0, weight = 0, deepest = 0;
  for (const auto& [depth, all] : by_depth) {
    const double here = sticking({0, 0, depth}).z();
    const std::optional<double> missing = here > 0 ? without_way(all, depth) : std::nullopt;
    if (!missing && depth == by_depth.rbegin()->first) return 0;
    if (!missing) continue;
    constexpr double kStep = 0.01;
    const double before = sticking({0, 0, (1 - kStep) * depth}).z();
    const double share = ((here - before) / (kStep * here) + 2) * depth / scale;
    deepest = *missing / share;  // the last
    sum += share * *missing;
    weight += share * share;
  }
  // Shallow contacts are small ones, of few elements: what they say beyond the deepest is not believed.
  constexpr double kBeyond = 1.5;
  return weight > 0 ? std::clamp(sum / weight, 0.0, kBeyond * std::max(deepest, 0.0)) : 0.0;
}

}  // namespace palpate::fit
