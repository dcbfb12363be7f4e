// SPDX-License-Identifier: GPL-3.0-or-later
// Ways of a contact that sticks deeper and less deep under side load, from points of the normal indentation.
#include "precompute/solve/contact/gates.hpp"
#include "precompute/solve/pair/error_estimate.hpp"
#include "precompute/solve/pair/pair_run.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;

// The normal indentation's state where the tool has moved by `depth`, interpolated between its points.
struct NormalState {
  Vector3d force{0, 0, 0};         // N, contact frame
  double depth = 0.0;              // m, corrected
  double tangential_energy = 0.0;  // J in the anchors: a push that sticks shears its contact from the middle outwards
};

NormalState normal_state(const PairRun& run, double depth) {
  const std::vector<CurvePoint>& curve = run.curve;
  const auto above = std::find_if(curve.begin(), curve.end(), [&](const CurvePoint& p) { return p.depth >= depth; });
  const CurvePoint& b = above == curve.end() ? curve.back() : *above;
  const CurvePoint& a = &b == curve.data() ? b : *(&b - 1);
  const double share = &a != &b ? std::clamp((depth - a.depth) / (b.depth - a.depth), 0.0, 1.0) : 1.0;
  const auto between = [share](double low, double high) { return low + share * (high - low); };
  return {run.sample_of(a).force + share * (run.sample_of(b).force - run.sample_of(a).force),
          between(run.sample_of(a).deflection.z(), run.sample_of(b).deflection.z()),
          between(a.contact.tangential_energy, b.contact.tangential_energy)};
}

// The cause of a failure, or nothing when the sample was taken.
std::optional<std::string> go(PairRun& run, const CurvePoint& from, WayEnergy& way, double angle,
                              const SidePath::Point& point, std::size_t index) {
  const Vector3d local(std::cos(angle), std::sin(angle), 0);
  const Vector3d target =
      from.state.translation + point.tangential * run.frame.to_world(local) - (point.depth - from.depth) * run.frame.n;
  const StepResult step = run.move_to(target, point.depth, true);
  ++run.result.outcome.tangential_solves;
  const auto where = " on the path at a tangential deflection of " + std::to_string(1e3 * point.tangential) +
                     " mm, at depth " + std::to_string(1e3 * point.depth) + " mm";
  if (!step.converged) return step.cause + where;
  way.moved();
  Sample s = run.sample(step.iterations);
  s.kind = SampleKind::path;
  s.index = static_cast<std::uint16_t>(index);
  const NormalState normal = normal_state(run, point.depth);
  const double pull = (s.force - normal.force).dot(local);
  const GateState gate = run.tangential_gate(point.depth, s, way);
  if (const auto failed = failed_sticking_gate(gate, pull, GateLimits{})) return *failed + where;
  // Elongation of the anchors (m), from the energy that the side load alone stores in them.
  const double sheared = std::max(gate.contact.tangential_energy - normal.tangential_energy, 0.0);
  const double give = pull < 0 ? 2 * sheared / -pull : 0.0;
  s.deflection = (point.tangential - std::min(give, 0.1 * point.tangential)) * local + Vector3d(0, 0, normal.depth);
  s.error_estimate = run.sample_of(from).error_estimate +
                     error_estimate({gate.contact.force.norm(), point.tangential, give, step.energy_error,
                                     run.push.state().penalty * gate.contact.area, s.contact_points});
  run.result.samples.push_back(s);
  return std::nullopt;
}

}  // namespace

void side_paths(PairRun& run) {
  for (std::size_t number = 0; number < run.path.side_paths.size(); ++number) {
    const SidePath& path = run.path.side_paths[number];
    const CurvePoint& from = run.point_from(path.from);
    run.push.restore(from.state);
    Sample start = run.sample_of(from);
    start.kind = SampleKind::path;
    start.index = static_cast<std::uint16_t>(number * kPathStride);
    run.result.samples.push_back(start);
    WayEnergy way(run.push);
    for (std::size_t k = 0; k < path.points.size(); ++k) {
      const auto failure = go(run, from, way, path.angle, path.points[k], number * kPathStride + k + 1);
      if (!failure) continue;
      run.result.outcome.cause = "stopped short: " + *failure;
      break;
    }
  }
}

}  // namespace palpate::solve
