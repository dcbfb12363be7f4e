// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene asks of its pairs.
#include "precompute/solve/coulomb_push.hpp"
#include "precompute/solve/pair.hpp"

#include <algorithm>

namespace palpate {

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

PairOptions pair_options(const Scene& scene) {
  PairOptions options;
  options.mesh_size = scene.solver.mesh_size;
  options.growth = scene.solver.growth;
  options.max_size = scene.solver.max_size;
  options.rim_size = scene.solver.rim_size;
  options.mesh.time_limit = scene.solver.time_limit;
  return options;
}

}  // namespace palpate
