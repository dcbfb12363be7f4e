// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/compliance/stiffening.hpp"

#include "precompute/compliance/spread_out.hpp"
#include "precompute/solve/reference/together.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

namespace palpate::compliance {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kPairs = 6;                 // solved
constexpr double kNearest = 1.25, kFarthest = 4;  // contact radii, between the two sites of a pair
constexpr std::size_t kShallow = 2;               // index of the step of a push at a quarter of the depth
constexpr double kMost = 1;                       // of the stiffening: layout::ComplianceHead

/// Normal force of a tool alone: a power law between two solved depths, and on from the last two.
class PushLaw {
public:
  explicit PushLaw(const std::vector<std::array<double, 2>>& pushed) : pushed_(pushed) {}

  /// N at a depth (m).
  [[nodiscard]] double force(double depth) const {
    std::size_t k = 1;
    while (k + 1 < pushed_.size() && depth > pushed_[k][0]) ++k;
    const auto [d0, f0] = pushed_[k - 1];
    const auto [d1, f1] = pushed_[k];
    return f1 * std::pow(depth / d1, std::log(f1 / f0) / std::log(d1 / d0));
  }

private:
  const std::vector<std::array<double, 2>>& pushed_;
};

/// Both tools have a force at every step.
bool has_laws(const solve::TogetherResult& pair) {
  return std::all_of(pair.pushed_alone.begin(), pair.pushed_alone.end(), [](const auto& pushed) {
    return std::all_of(pushed.begin(), pushed.end(), [](const auto& at) { return at[0] > 0 && at[1] > 0; });
  });
}

/// Forces (N) along the normals of two tools at depths z (m) whose dents lift each other: h(z_k) - h(d_k) = c f_j /
/// h'_j, with h as in the runtime's Compliance. `bend` (1/m): h''. `c`: m/N, n . C n between them.
std::array<double, 2> joint_forces(const solve::TogetherResult& pair, const std::array<double, 2>& z, double c,
                                   double bend) {
  constexpr int kSweeps = 50;  // C f is a fraction of the depth
  const auto stretched = [&](double d) { return d + 0.5 * bend * d * d; };
  const auto depth_at = [&](double h) {
    return bend > 0 ? (std::sqrt(std::max(0.0, 1 + 2 * bend * h)) - 1) / bend : h;
  };
  const PushLaw law[2] = {PushLaw(pair.pushed_alone[0]), PushLaw(pair.pushed_alone[1])};
  std::array<double, 2> d = z, force{};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t k = 0; k < 2; ++k) {
      const double other = law[1 - k].force(d[1 - k]) / (1 + bend * d[1 - k]);
      d[k] = std::max(1e-3 * z[k], depth_at(stretched(z[k]) - c * other));
    }
  }
  for (std::size_t k = 0; k < 2; ++k) force[k] = law[k].force(d[k]) * (1 + bend * z[k]) / (1 + bend * d[k]);
  return force;
}

/// n . C n between two tools (m/N) with which they have, at step `step` of the push, the solved sum of forces
/// (bisection).
double compliance_at(const solve::TogetherResult& pair, std::size_t step, double bend) {
  constexpr int kHalvings = 40;
  const auto &one = pair.pushed_together[0][step], &other = pair.pushed_together[1][step];
  const double solved = one[1] + other[1], most = 2 * (one[0] + other[0]) / solved;
  double low = -most, high = most;
  for (int k = 0; k < kHalvings; ++k) {
    const double c = 0.5 * (low + high);
    const std::array<double, 2> force = joint_forces(pair, {one[0], other[0]}, c, bend);
    (force[0] + force[1] > solved ? low : high) = c;
  }
  return 0.5 * (low + high);
}

/// Mean error of what tools at full depth lose to each other, over their forces alone. Squares would let the pair at
/// the sharpest rim decide, where dents are not linear at all.
double error(const std::vector<solve::TogetherResult>& pairs, double bend) {
  double sum = 0;
  for (const solve::TogetherResult& pair : pairs) {
    const double c = compliance_at(pair, kShallow, bend);
    const std::array<double, 2> force =
        joint_forces(pair, {pair.pushed_together[0].back()[0], pair.pushed_together[1].back()[0]}, c, bend);
    for (std::size_t k = 0; k < 2; ++k) {
      sum += std::abs(force[k] - pair.together[k].z()) / pair.alone[k].z();
    }
  }
  return sum / (2 * double(pairs.size()));
}

/// Place of the minimum of a function that has one in [0, most] (golden section).
template <class Function>
double least(const Function& f, double most) {
  constexpr double kRatio = 0.6180339887498949;
  constexpr int kShrinks = 30;
  double low = 0, high = most, a = high - kRatio * (high - low), b = low + kRatio * (high - low), fa = f(a), fb = f(b);
  for (int step = 0; step < kShrinks; ++step) {
    if (fa <= fb) {
      high = b;
      b = a;
      fb = fa;
      a = high - kRatio * (high - low);
      fa = f(a);
    } else {
      low = a;
      a = b;
      fa = fb;
      b = low + kRatio * (high - low);
      fb = f(b);
    }
  }
  const double found = 0.5 * (low + high);
  return f(0) <= f(found) ? 0 : found;
}

ContactFrame frame_at(const LoadSite& site) {
  ContactFrame frame;
  frame.origin = site.point;
  frame.n = site.normal;
  frame.x = site.normal.unitOrthogonal();
  frame.y = frame.n.cross(frame.x);
  return frame;
}

/// The nearest site beside one that two tools can be pressed at together, if there is one.
std::optional<std::size_t> partner(const ComplianceSites& sites, const PressedTool& pressed, std::size_t site) {
  const Vector3d& at = sites.places[site].point;
  const double radius = tool::contact_radius(pressed.vertex, pressed.depth[site]);
  std::optional<std::size_t> found;
  double nearest = kFarthest * radius;
  for (std::size_t s = 0; s < sites.places.size(); ++s) {
    const double apart = (sites.places[s].point - at).norm();
    if (pressed.depth[s] < pressed.depth[site] || apart < kNearest * radius || apart >= nearest) continue;
    nearest = apart;
    found = s;
  }
  return found;
}

}  // namespace

StiffeningReport measure_stiffening(const Body& body, const ComplianceSites& sites, const PressedTool& pressed,
                                    double depth_scale, const solve::PairOptions& solver) {
  std::vector<char> usable;
  for (const double depth : pressed.depth) usable.push_back(depth > 0 ? 1 : 0);
  StiffeningReport report;
  report.cause = "no two sites lie near enough to each other";
  std::vector<solve::TogetherResult> pairs;
  std::set<std::pair<std::size_t, std::size_t>> seen;
  for (const std::size_t site : spread_out(sites.places, usable)) {
    if (seen.size() == kPairs) break;
    const std::optional<std::size_t> other = partner(sites, pressed, site);
    if (!other || !seen.emplace(std::min(site, *other), std::max(site, *other)).second) continue;
    solve::TogetherPath path;
    path.places = {frame_at(sites.places[site]), frame_at(sites.places[*other])};
    path.depth = pressed.depth[site];
    path.steps = 2 * (kShallow + 1);  // the depth goes with the square of the step
    solve::TogetherResult pair = solve::solve_together(body, pressed.tool, pressed.vertex, path, solver);
    if (pair.usable && has_laws(pair)) {
      pairs.push_back(std::move(pair));
    } else {
      report.cause = pair.usable ? "a tool has no force at a step of its push" : pair.cause;
    }
  }
  report.pairs = pairs.size();
  if (pairs.empty()) return report;
  report.cause.clear();
  const double bend = least([&](double b) { return error(pairs, b); }, kMost / depth_scale);
  report.stiffening = bend * depth_scale;
  report.error = error(pairs, bend);
  report.error_without = error(pairs, 0);
  return report;
}

}  // namespace palpate::compliance
