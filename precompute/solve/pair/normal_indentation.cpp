// SPDX-License-Identifier: GPL-3.0-or-later
// The curve of the normal indentation: each depth solved from the last, passed by the gates, freed of the penalty's
// give.
#include "precompute/solve/contact/gates.hpp"
#include "precompute/solve/pair/error_estimate.hpp"
#include "precompute/solve/pair/pair_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace palpate::solve {
namespace {

// Depth less the penalty's own compliance: d - dE/dF at fixed stiffness, from the local power law
// E k ~ F^m of neighbouring points (4/3 for a sphere, 2 for a constant contact area).
double corrected_depth(const std::vector<CurvePoint>& curve, std::size_t k) {
  const CurvePoint& here = curve[k];
  double m = 4.0 / 3;
  const std::size_t a = k > 0 ? k - 1 : k, b = k > 0 ? k : std::min(k + 1, curve.size() - 1);
  if (a != b && curve[b].force > 1.05 * curve[a].force && curve[a].force > 0) {
    const double ea = curve[a].contact.normal_energy * curve[a].state.penalty;
    const double eb = curve[b].contact.normal_energy * curve[b].state.penalty;
    if (ea * eb > 0) m = std::clamp(std::log(eb / ea) / std::log(curve[b].force / curve[a].force), 1.0, 2.0);
  }
  return here.depth - m * here.contact.normal_energy / here.force;
}

// Integral of the force over the depth, a power law between two points (from zero: Hertz' 3/2, or linear).
double power_law_work(double z0, double f0, double z1, double f1) {
  if (!(f1 > 0)) return 0.0;
  const double m = std::log(f1 / f0) / std::log(z1 / z0);
  return std::abs(m + 1) > 1e-6 ? (f1 * z1 - f0 * z0) / (m + 1) : f1 * z1 * std::log(z1 / z0);
}

// Force ratio of gross slip for a coefficient of 1, predicted from the slopes of the contact: the mean over directions.
double slip_ratio(const PairRun& run) {
  double mean = 0;
  for (int k = 0; k < 8; ++k) {
    const double angle = std::numbers::pi * k / 4;
    mean += run.push.contact().slip_ratio(run.push.state().x,
                                          std::cos(angle) * run.frame.x + std::sin(angle) * run.frame.y, run.frame.n) /
            8;
  }
  return mean;
}

// The push to one depth: appends a point and its sample, nothing where the contact is still too small to resolve. The
// cause where it fails.
std::optional<std::string> push_to(PairRun& run, double depth, double& work) {
  const GateLimits limits;
  const double deepest = run.path.normal_depths.back();
  const bool sticking = run.path.friction > 0 && !run.path.form_frictionless;
  const auto fail = [&run](const std::string& cause, bool of_contact) {
    run.contact_failed = of_contact;
    return cause;
  };
  const StepResult step = run.move_to(run.start - depth * run.frame.n, depth, sticking);
  ++run.result.outcome.normal_solves;
  if (!step.converged) {
    return fail("normal push at depth " + std::to_string(1e3 * depth) + " mm: " + step.cause, true);
  }
  CurvePoint point{depth, run.push.report(), 0.0, run.push.state(), step.energy_error};
  point.force = point.contact.force.dot(run.frame.n);
  const double last_force = run.curve.empty() ? 0.0 : run.curve.back().force;
  const double last_depth = run.curve.empty() ? 0.0 : run.curve.back().depth;
  if (point.contact.points < limits.resolved_points) {
    if (depth < deepest) return std::nullopt;
    return fail("contact resolution: " + std::to_string(point.contact.points) + " points in contact at full depth, " +
                    std::to_string(limits.resolved_points) + " wanted",
                false);
  }
  work += run.curve.empty() ? point.force * depth / (run.vertex.flat_radius > 0 ? 2.0 : 2.5)
                            : power_law_work(last_depth, last_force, depth, point.force);
  Sample sample = run.sample(step.iterations);
  const GateState gate{depth,
                       run.radius(depth),
                       point.force,
                       last_force,
                       work,
                       run.push.elastic_energy() + point.contact.normal_energy + point.contact.tangential_energy,
                       run.work_scale(deepest),
                       sample.min_jacobian,
                       point.contact};
  if (const auto failed = failed_gate(gate, limits)) return fail(*failed, !sinks_into_held(gate, limits));
  if (run.options.watch) run.options.watch(run.mesh, run.push.state().x, depth);
  run.curve.push_back(std::move(point));
  sample.friction_limit = run.path.friction > 0 ? run.path.friction * slip_ratio(run) : 0.0;
  sample.index = static_cast<std::uint16_t>(run.curve.size() - 1);
  run.result.samples.push_back(sample);
  return std::nullopt;
}

}  // namespace

bool normal_indentation(PairRun& run) {
  const PairPath& path = run.path;
  const GateLimits limits;
  run.push.set_anchor_stiffness(run.options.penalty * run.body.material.young / run.radius(path.normal_depths.back()));
  std::vector<CurvePoint>& curve = run.curve;
  double work = 0.0;
  std::optional<std::string> cause;
  for (auto depth = path.normal_depths.begin(); !cause && depth != path.normal_depths.end(); ++depth) {
    cause = push_to(run, *depth, work);
  }
  const std::size_t wanted = std::min(limits.curve_points, path.normal_depths.size());
  if (curve.size() < wanted) {
    return run.refuse(cause ? *cause
                            : "contact resolution: " + std::to_string(curve.size()) + " of " +
                                  std::to_string(path.normal_depths.size()) +
                                  " depths have enough points in contact, " + std::to_string(wanted) + " wanted");
  }
  for (std::size_t k = 0; k < curve.size(); ++k) {
    const CurvePoint& point = curve[k];
    const double depth = corrected_depth(curve, k);
    Sample& sample = run.result.samples[k];
    sample.deflection = {0, 0, depth};
    sample.error_estimate =
        error_estimate({point.contact.force.norm(), point.depth, point.depth - depth, point.energy_error,
                        point.state.penalty * point.contact.area, point.contact.points});
  }
  run.result.outcome.cause = cause.value_or("");
  return !cause;
}

}  // namespace palpate::solve
