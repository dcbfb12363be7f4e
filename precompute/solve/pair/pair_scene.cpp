// SPDX-License-Identifier: GPL-3.0-or-later
// The paths and options of a scene's pairs.
#include "precompute/solve/pair/contact_size.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "precompute/solve/push/coulomb_push.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::solve {
PairPath bake_path(const Scene& scene, double depth) {
  PairPath path;
  const int n = scene.sampling.normal_points;
  for (int k = 1; k <= n; ++k) path.normal_depths.push_back(depth * k * k / (static_cast<double>(n) * n));
  path.friction = scene.friction;
  if (scene.friction > 0) {
    const int m = scene.sampling.tangential_depths;
    for (int k = 1; k <= m; ++k) path.tangential_depths.push_back(path.normal_depths[(n * k + m - 1) / m - 1]);
    path.tangential_directions = scene.sampling.tangential_directions;
    path.tangential_points = scene.sampling.tangential_points;
    // Gross slip of a Hertz contact begins at mu (2 - nu) / (3 (1 - nu)) of the depth (Mindlin 1949); beyond
    // the whole depth a sticking contact without cohesion peels.
    const double nu = scene.material.poisson;
    path.tangential_reach = std::clamp(1.2 * scene.friction * (2 - nu) / (3 * (1 - nu)), 0.1, 1.0);
    if (scene.sampling.friction_limit == SamplingScene::FrictionLimit::solved) {
      // A contact as deep as the tip's radius slips as a whole at 1.3 of what Mindlin's law says, and its force ratio
      // is 1.5 % from that of a long slide at 2. The mean over three directions is free of a force that a lump to one
      // side or a longish contact adds.
      path.slip_points = 3;
      path.slip_directions = 3;
      path.slip_reach = 2.0 * gross_slip_reach(scene.friction, nu);
    }
  }
  return path;
}

PairPath normal_path(const Scene& scene, double depth) {
  PairPath path;
  path.normal_depths = bake_path(scene, depth).normal_depths;
  path.friction = scene.friction;
  return path;
}

void add_grasp(PairPath& path, const Scene& scene, const ToolScene& tool, double depth) {
  if (!(tool.grasp_depth > 0)) return;
  path.grasp_depth = std::min(tool.grasp_depth, depth);
  // One that is there already, but for a few per cent, is not solved twice.
  const auto near = [&](double other) { return std::abs(other - path.grasp_depth) < 0.03 * depth; };
  const auto found = std::find_if(path.normal_depths.begin(), path.normal_depths.end(), near);
  if (found != path.normal_depths.end()) {
    path.grasp_depth = *found;
  } else {
    path.normal_depths.insert(std::upper_bound(path.normal_depths.begin(), path.normal_depths.end(), path.grasp_depth),
                              path.grasp_depth);
  }
  const int half = std::max(2, scene.sampling.normal_points / 2);
  for (int k = -half; k <= half; ++k) path.grasp_depths.push_back(depth * k / half);
  path.grasp_directions = scene.sampling.tangential_directions;
  path.grasp_reach = depth / 2;
  for (int k = 0; tool.grasp_turn > 0 && k < 6; ++k) {
    path.grasp_turns.emplace_back((k < 3 ? 1 : -1) * tool.grasp_turn * Eigen::Vector3d::Unit(k % 3));
  }
}

std::vector<SidePath> test_paths(const PairPath& path, double angle) {
  const double deepest = path.normal_depths.back(), reach = path.tangential_reach * deepest, shallow = 0.25 * deepest;
  SidePath diagonal{shallow, angle, {}}, deeper = diagonal, lift{deepest, angle, {}};
  constexpr int kPoints = 6;
  for (int k = 1; k <= kPoints; ++k) {
    const double share = static_cast<double>(k) / kPoints;
    diagonal.points.push_back({share * reach, shallow + share * (deepest - shallow)});
    // A third tangential, the rest up or down.
    const double side = std::min(1.0, 3 * share), way = std::max(0.0, 1.5 * share - 0.5);
    deeper.points.push_back({side * 0.25 * reach, shallow + way * (deepest - shallow)});
    lift.points.push_back({side * 0.5 * reach, deepest - way * 0.5 * deepest});
  }
  return {diagonal, deeper, lift};
}

PairOptions pair_options(const Scene& scene) {
  PairOptions options;
  options.mesh_size = scene.solver.mesh_size;
  options.growth = scene.solver.growth;
  options.max_size = scene.solver.max_size;
  options.rim_size = scene.solver.rim_size;
  options.time_limit = scene.solver.time_limit;
  options.memory_limit = 1e6 * scene.solver.memory_limit;
  options.mesh_errors = true;
  return options;
}

void without_limits(PairOptions& options) {
  options.time_limit = options.memory_limit = std::numeric_limits<double>::infinity();
  options.mesh_errors = false;
}

PairOptions finer_options(PairOptions options, const Body& body, double refine) {
  options.refine *= refine;
  options.growth *= std::pow(refine, 0.7);
  options.max_size = longest_edge(body, options) * std::pow(refine, 0.8);
  return options;
}

}  // namespace palpate::solve
