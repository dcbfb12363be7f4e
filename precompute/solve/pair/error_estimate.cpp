// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/pair/error_estimate.hpp"

#include "precompute/solve/pair/sample_difference.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace palpate::solve {
namespace {

// Shares of two bounds that count as error: kIterate of the Cauchy-Schwarz bound, and kPenalty of the relative give,
// which is already subtracted to first order.
constexpr double kIterate = 0.2, kPenalty = 0.3;
// A contact of few points is seen unevenly.
constexpr double kPoints = 1.5;

using Eigen::Vector3d;

// Error of the change of the force in a tangential push that the other mesh did not solve.
constexpr double kUnknownTangential = 0.1;

// By depth (m).
using ByDepth = std::map<double, double>;

ByDepth::const_iterator nearest(const ByDepth& values, double depth) {
  auto above = values.lower_bound(depth);
  if (above == values.end()) return std::prev(above);
  if (above == values.begin()) return above;
  const auto below = std::prev(above);
  return depth - below->first < above->first - depth ? below : above;
}

// The largest of the values at the nearest depth and beside it: two meshes may agree at one depth by chance.
double around(const ByDepth& values, double depth) {
  const auto at = nearest(values, depth);
  double largest = at->second;
  if (at != values.begin()) largest = std::max(largest, std::prev(at)->second);
  if (std::next(at) != values.end()) largest = std::max(largest, std::next(at)->second);
  return largest;
}

// The normal indentation from which a sample started, or which is as deep.
const Sample& base_of(const std::vector<Sample>& samples, const Sample& of) {
  const Sample* base = nullptr;
  const auto away = [&](const Sample& s) { return std::abs(s.deflection.z() - of.deflection.z()); };
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::normal && (base == nullptr || away(s) < away(*base))) base = &s;
  }
  return *base;
}

}  // namespace

double error_estimate(const ErrorSources& s) {
  // An energy error e is one of the positions whose norm in the energy is sqrt(2 e); of the force on the tool it is at
  // most that times the norm of the contact's stiffness (Cauchy-Schwarz).
  const double iterate = kIterate * std::sqrt(2 * std::max(s.energy_error, 0.0) * s.contact_stiffness) / s.force;
  const double penalty = kPenalty * std::abs(s.give) / s.depth;
  return iterate + penalty + kPoints / std::max<double>(s.points, 1);
}

PairPath compared_path(PairPath path) {
  path.side_paths.clear();
  path.slip_points = 0;
  path.grasp_depth = 0.0;
  if (path.tangential_directions == 0) return path;
  path.tangential_directions = 1;
  path.tangential_reach /= path.tangential_points;
  path.tangential_points = 1;
  return path;
}

bool add_mesh_errors(std::vector<Sample>& samples, const std::vector<Sample>& other, double share) {
  ByDepth normal, tangential;
  for (const ComparedSample& c : sample_difference(samples, other).samples) {
    const Sample& s = samples[c.sample];
    if (s.kind == SampleKind::normal) {
      normal[s.deflection.z()] = c.difference;
      continue;
    }
    const Sample& o = other[c.other];
    const Vector3d change = s.force - base_of(samples, s).force, its = o.force - base_of(other, o).force;
    double& at = tangential[s.deflection.z()];
    if (its.norm() > 0) at = std::max(at, (change - its).norm() / its.norm());
  }
  if (normal.empty()) return false;
  for (Sample& s : samples) {
    double error = around(normal, s.deflection.z());
    if (s.kind != SampleKind::normal) {
      const Vector3d& base = base_of(samples, s).force;
      const double change = (s.force - base).norm() / std::max(s.force.norm(), base.norm());
      error += change * (tangential.empty() ? kUnknownTangential : nearest(tangential, s.deflection.z())->second);
    }
    s.error_estimate += share * error;
  }
  return true;
}

}  // namespace palpate::solve
