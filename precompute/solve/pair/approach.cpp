// SPDX-License-Identifier: GPL-3.0-or-later
// From the mesh free of stress to the tool that just touches it.
#include "precompute/solve/pair/pair_run.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;

// How far apart, in contact radii at full depth, the meshes of body and pair may carry a site by prestress.
constexpr double kCarried = 0.5;

// Prestress acts before the tool comes near. It carries the site's node a little elsewhere than on the mesh that the
// site's frame is from: the tool goes for the node. By how much (m); nothing where the pair is refused.
std::optional<Vector3d> settle(PairRun& run) {
  if (!run.body.stress_free) {
    run.refuse("prestress: the site is on a surface without its loads; apply_prestress() must come first");
    return std::nullopt;
  }
  const Settled settled =
      run.push.settle(std::pow(run.options.tolerance, 2) * run.work_scale(run.path.normal_depths.front()));
  if (!settled.reached) {
    run.refuse("prestress: " + settled.cause);
    return std::nullopt;
  }
  const Vector3d site = run.body.material_point(run.frame.origin).point;
  const std::vector<Vector3d>& nodes = run.mesh.nodes;
  Eigen::Index node = 0;
  for (Eigen::Index k = 1; k < run.mesh.corner_count; ++k) {
    if ((nodes[std::size_t(k)] - site).norm() < (nodes[std::size_t(node)] - site).norm()) node = k;
  }
  const Vector3d carried = run.push.state().x.segment<3>(3 * node) - run.frame.origin;
  const double most = kCarried * run.radius(run.path.normal_depths.back());
  if (carried.norm() <= most) return carried;
  run.refuse("prestress: carries the site " + std::to_string(1e3 * carried.norm()) +
             " mm from where it was found to stand, allowed " + std::to_string(1e3 * most) + " mm");
  return std::nullopt;
}

// The tool starts where it first touches the meshed surface on its way along -n.
bool first_touch(PairRun& run) {
  const double deepest = run.path.normal_depths.back();
  const double limit = 2 * std::max(run.vertex.curvature_radius, deepest);
  double lift = 0.0, gap = run.push.rest_gap(run.start);
  const double resolution = 1e-9 + 1e-6 * deepest;
  while (gap < 0 && lift < limit) {
    lift += std::max(-gap, resolution);
    gap = run.push.rest_gap(run.start + lift * run.frame.n);
  }
  if (gap < 0) {
    return run.refuse("first touch: the tool overlaps the body even when lifted by " + std::to_string(1e3 * lift) +
                      " mm");
  }
  for (int k = 0; k < 200 && gap > resolution; ++k) {
    lift -= gap;
    gap = run.push.rest_gap(run.start + lift * run.frame.n);
  }
  if (lift < -limit) {
    return run.refuse("first touch: the surface is " + std::to_string(-1e3 * lift) + " mm beyond the site");
  }
  run.start += lift * run.frame.n;
  run.result.outcome.first_touch = -lift;
  return true;
}

}  // namespace

bool approach(PairRun& run) {
  run.start = run.push.state().translation;
  if (run.body.prestress.any()) {
    const std::optional<Vector3d> carried = settle(run);
    if (!carried) return false;
    run.start += *carried;
  }
  return first_touch(run);
}

}  // namespace palpate::solve
