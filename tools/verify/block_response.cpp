// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/block_response.hpp"

#include "formats/io/error.hpp"
#include "precompute/fit/closed_form.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace palpate::cli {
namespace {

using Eigen::Vector3d;

constexpr double kTolerance = 1e-3;  // of the fit to the solved push

/// The block as a scene, before its first solve.
pipeline::Pipeline block_pipeline(const ContactCase& c) {
  pipeline::Pipeline p;
  p.scene = c.scene;
  p.scene.response.tolerance = kTolerance;
  p.body = c.body;
  p.tools = {c.tool};
  p.mesh = sites::make_haptic_mesh(p.scene, p.body);
  pipeline::find_pairs(p);
  return p;
}

}  // namespace

BlockResponse::BlockResponse(const ContactCase& contacts)
    : pipeline_(block_pipeline(contacts)), compliance_(pipeline::compliance(pipeline_).file) {}

std::vector<std::byte> BlockResponse::file(const solve::TogetherResult& solved) {
  // Between solved depths the force over depth^1.5 is linear.
  const auto force = [&](const Vector3d& deflection) {
    const double z = deflection.z();
    const auto& at = solved.pushed_alone.front();
    const auto ratio = [&](std::size_t k) { return at[k][1] / std::pow(at[k][0], 1.5); };
    std::size_t k = 1;
    while (k + 1 < at.size() && at[k][0] < z) ++k;
    const double share = std::clamp((z - at[k - 1][0]) / (at[k][0] - at[k - 1][0]), 0.0, 1.0);
    return Vector3d(0, 0, std::pow(z, 1.5) * ((1 - share) * ratio(k - 1) + share * ratio(k)));
  };
  pipeline_.sources.solve_others = false;
  for (std::uint32_t pair = 0; pair < pipeline_.plan.pairs.size(); ++pair) {
    pipeline_.sources.external[pair].samples =
        fit::sample_along(solve::bake_path(pipeline_.scene, pipeline_.plan.pairs[pair].depth), force);
  }
  return pipeline::fit_file(pipeline_, {}, pipeline::fit_settings(pipeline_), &compliance_).bytes;
}

std::unique_ptr<ResponseInput> response_with_compliance(const std::string& scene, const std::string& response) {
  pipeline::Options options;
  options.response = response;
  const std::filesystem::path file = pipeline::paths_of(scene, options).response;
  auto input = std::make_unique<ResponseInput>(file.string());
  if (!input->view().has(layout::feature_compliance)) {
    throw Error(ExitCode::bad_input,
                file.string() + ": has no compliance; add [compliance] to the scene and fit again");
  }
  return input;
}

runtime::Pose to_pose(const Eigen::Isometry3d& pose) {
  runtime::Pose result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.rotation[3 * i + j] = pose.linear()(i, j);
  }
  result.translation = {pose.translation().x(), pose.translation().y(), pose.translation().z()};
  return result;
}

}  // namespace palpate::cli
