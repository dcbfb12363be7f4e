// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/inspect/features.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "precompute/fit/laws/grasp_fit.hpp"
#include "precompute/solve/pair/pair.hpp"

namespace palpate::cli {
namespace {

/// A feature that a file has not, in the form of a usual fit.
struct UsualForm {
  int degree = 3;  ///< of bias, stiffness and friction
  double friction = 0.3;
  float softening = 0.5F * layout::kMaxSoftening;
  double grasp_turn = 0.1;  ///< rad
};
constexpr UsualForm kUsual;

/// Depths from which a bonded tool is drawn aside and turned: the deepest push, depth 0 and the furthest pull.
constexpr std::size_t kGraspLevels = 3;

void add_friction(ResponseFileContent& content) {
  response::Degrees& degrees = content.degrees;
  degrees.stiffness = degrees.friction = kUsual.degree;
  degrees.friction_families = true;
  content.tangential_scale = content.depth_scale;
  const response::Offsets o = response::offsets(degrees);
  for (Response& r : content.responses) {
    const std::int16_t largest = r.coefficients[static_cast<std::size_t>(o.bias) - 1];
    r.coefficients.resize(static_cast<std::size_t>(o.end));
    for (int k = o.stiffness; k < o.coupling; k += 3) r.coefficients[static_cast<std::size_t>(k)] = largest;
    for (int k = o.friction; k < o.end; ++k) {
      r.coefficients[static_cast<std::size_t>(k)] =
          static_cast<std::int16_t>(std::lround(kUsual.friction / layout::kFrictionUnit));
    }
  }
}

/// Equilibria of one path that the feature takes.
std::size_t path_solves(const solve::PairPath& path, layout::Feature feature) {
  const auto product = [](std::size_t a, int b, int c) {
    return a * static_cast<std::size_t>(b) * static_cast<std::size_t>(c);
  };
  switch (feature) {
    case layout::feature_friction:
      return product(path.tangential_depths.size(), path.tangential_directions, path.tangential_points);
    case layout::feature_slip_softening:
      return product(path.tangential_depths.size(),
                     path.slip_directions > 0 ? path.slip_directions : path.tangential_directions, path.slip_points);
    case layout::feature_bonded:
      return path.grasp_depths.size() + product(kGraspLevels, path.grasp_directions, path.grasp_points);
    case layout::feature_bonded_torque:
      return kGraspLevels * path.grasp_turns.size();
    default:
      return 0;
  }
}

}  // namespace

ResponseFileContent with_feature(ResponseFileContent content, layout::Feature feature) {
  const response::Offsets o = response::offsets(content.degrees);
  switch (feature) {
    case layout::feature_tangential_bias:
      if (content.degrees.bias > 0) break;
      content.degrees.bias = kUsual.degree;
      for (Response& r : content.responses) {
        r.coefficients.insert(r.coefficients.begin() + o.bias, 2 * response::from_square(kUsual.degree), 0);
      }
      break;
    case layout::feature_friction:
      if (!content.degrees.friction_families) add_friction(content);
      break;
    case layout::feature_slip_softening:
      if (content.slip_softening) break;
      content = with_feature(std::move(content), layout::feature_friction);
      content.slip_softening = true;
      for (Response& r : content.responses) r.softening = kUsual.softening;
      break;
    case layout::feature_search:
      if (content.search.empty()) add_search(content);
      break;
    default:
      break;
  }
  return content;
}

ResponseFileContent without_feature(ResponseFileContent content, layout::Feature feature) {
  const response::Offsets o = response::offsets(content.degrees);
  switch (feature) {
    case layout::feature_tangential_bias:
      content.degrees.bias = 0;
      for (Response& r : content.responses) {
        r.coefficients.erase(r.coefficients.begin() + o.bias, r.coefficients.begin() + o.stiffness);
      }
      break;
    case layout::feature_friction:
      content = without_feature(std::move(content), layout::feature_slip_softening);
      content.degrees.stiffness = content.degrees.friction = 0;
      content.degrees.friction_families = false;
      content.tangential_scale = 0;
      for (Response& r : content.responses) r.coefficients.resize(static_cast<std::size_t>(o.stiffness));
      break;
    case layout::feature_slip_softening:
      content.slip_softening = false;
      for (Response& r : content.responses) r.softening = 0;
      break;
    case layout::feature_search:
      content.search.clear();
      break;
    default:
      break;
  }
  return content;
}

double feature_bytes(const layout::Meta& m, layout::Feature feature) {
  constexpr auto kDegree = static_cast<std::uint32_t>(kUsual.degree);
  const std::uint32_t bonded_coefs = m.bonded_coefs > 0 ? m.bonded_coefs : fit::kGraspCoefs;
  layout::Meta with = m, without = m;
  switch (feature) {
    case layout::feature_friction:
      if (!layout::has_friction(m)) with.tangential_scale = 1, with.stiffness_degree = with.friction_degree = kDegree;
      without.tangential_scale = 0;
      break;
    case layout::feature_tangential_bias:
      if (m.bias_degree == 0) with.bias_degree = kDegree;
      without.bias_degree = 0;
      break;
    case layout::feature_slip_softening:
      with.softening_count = 1;
      without.softening_count = 0;
      break;
    case layout::feature_bonded:
      return layout::bonded_size(bonded_coefs);
    case layout::feature_bonded_torque:
      return layout::torque_size(bonded_coefs);
    default:
      return 0;  // a section of its own, not a part of a response
  }
  return double(layout::response_size(with)) - double(layout::response_size(without));
}

std::optional<double> feature_solves(const pipeline::Pipeline& p, layout::Feature feature) {
  constexpr std::uint32_t kOtherPlan = layout::feature_tool_patches | layout::feature_spin | layout::feature_compliance;
  if ((feature & kOtherPlan) != 0) return std::nullopt;
  Scene scene = p.scene;
  if (!(scene.friction > 0)) scene.friction = kUsual.friction;
  if (feature == layout::feature_slip_softening) {
    scene.sampling.friction_limit = SamplingScene::FrictionLimit::solved;
  }
  const auto bonds = [&](const ToolScene& tool) {
    return feature == layout::feature_bonded ? tool.grasp_depth > 0 : tool.grasp_turn > 0;
  };
  const bool used = std::any_of(scene.tools.begin(), scene.tools.end(), bonds);
  std::size_t solves = 0;
  for (std::uint32_t k = 0; k < p.plan.pairs.size(); ++k) {
    const PairPlan& pair = p.plan.pairs[k];
    if (pair.role != PairRole::full || !p.sources.solved(k)) continue;
    ToolScene tool = p.tools[pair.tool].scene;
    if (!used) {
      tool.grasp_depth = pair.depth;
      tool.grasp_turn = kUsual.grasp_turn;
    }
    solve::PairPath path = solve::bake_path(scene, pair.depth);
    solve::add_grasp(path, scene, tool, pair.depth);
    solves += path_solves(path, feature);
  }
  return double(solves);
}

}  // namespace palpate::cli
