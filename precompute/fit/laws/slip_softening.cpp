// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/laws/slip_softening.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "palpate/format/response_layout.hpp"

namespace palpate::fit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Softening of one slipping push.
struct Shortfall {
  Vector2d slip;   ///< m, displacement beyond the deflection that friction holds
  double missing;  ///< of F, by which the normal force is below that of a sticking contact
};

/// Deflection (m, at most `most`) along the unit vector u at which a sticking contact has the tangential force `wanted`
/// (N) beyond that of the normal push.
double held_deflection(double wanted, double depth, const Vector2d& u, double most, const StickingForce& sticking) {
  const auto force = [&](double way) {
    return -(sticking({way * u.x(), way * u.y(), depth}) - sticking({0, 0, depth})).head<2>().dot(u);
  };
  double low = 0, high = most;
  if (force(high) < wanted) return high;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (force(middle) < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Shortfall shortfall(const Sample& s, const Sample& normal, const StickingForce& sticking) {
  const double depth = s.deflection.z(), moved = s.deflection.head<2>().norm();
  const Vector2d u = s.deflection.head<2>() / moved;
  const double wanted = -(s.force - normal.force).head<2>().dot(u);
  const double held = held_deflection(wanted, depth, u, moved, sticking);
  const double sticks = sticking({held * u.x(), held * u.y(), depth}).z();
  return {(moved - held) * u, (sticks - s.force.z()) / sticking({0, 0, depth}).z()};
}

/// The missing share at one depth without slip displacement. Empty when the pushes do not determine it.
std::optional<double> without_slip(const std::vector<Shortfall>& all, double depth) {
  constexpr Eigen::Index kUnknowns = 4;
  // At a margin the tool slides off the pressed tissue, and a square of the displacement does not describe that.
  constexpr double kMostMissing = 0.25;
  for (const Shortfall& one : all) {
    if (!(std::abs(one.missing) <= kMostMissing)) return std::nullopt;
  }
  const auto count = static_cast<Eigen::Index>(all.size());
  if (count < kUnknowns) return std::nullopt;
  Eigen::MatrixXd rows(count, kUnknowns);
  Eigen::VectorXd target(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Shortfall& one = all[static_cast<std::size_t>(i)];
    const Vector2d slip = one.slip / depth;
    rows.row(i) << 1, slip.x(), slip.y(), slip.squaredNorm();
    target[i] = one.missing;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(rows);
  if (solver.rank() < kUnknowns) return std::nullopt;
  const double missing = solver.solve(target)[0];
  if (!(std::abs(missing) <= kMostMissing)) return std::nullopt;
  return missing;
}

}  // namespace

double slip_softening(const std::vector<Sample>& samples, const StickingForce& sticking, double depth_scale) {
  std::map<double, std::vector<Shortfall>> by_depth;  // a slipping push has the depth of its normal push, bit by bit
  std::map<double, const Sample*> normal;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::normal) normal[s.deflection.z()] = &s;
  }
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::slipping || !(s.friction_limit > 0)) continue;  // 0: a part of it still sticks
    const auto from = normal.find(s.deflection.z());
    if (from != normal.end()) by_depth[s.deflection.z()].push_back(shortfall(s, *from->second, sticking));
  }
  // Least squares of missing = k z / Z.
  double sum = 0, weight = 0, deepest = 0;
  for (const auto& [depth, all] : by_depth) {
    const std::optional<double> missing = without_slip(all, depth);
    if (!missing && depth == by_depth.rbegin()->first) return 0;
    if (!missing) continue;
    const double share = std::min(depth / depth_scale, 1.0);
    deepest = *missing / share;  // the last of them
    sum += share * *missing;
    weight += share * share;
  }
  constexpr double kBeyond = 1.5;  // times the deepest, that k may be
  const double most = std::min(kBeyond * std::max(deepest, 0.0), static_cast<double>(layout::kMaxSoftening));
  return weight > 0 ? std::clamp(sum / weight, 0.0, most) : 0.0;
}

}  // namespace palpate::fit
