// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/verify_together.hpp"

#include "formats/io/error.hpp"
#include "formats/io/same_file.hpp"
#include "palpate/format/open.hpp"
#include "palpate/shared/tool_set.hpp"
#include "precompute/fit/closed_form.hpp"
#include "precompute/pipeline/pipeline.hpp"
#include "precompute/verify/contact_checks.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/contact_case.hpp"
#include "tools/cli/interrupt.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/response_input.hpp"
#include "tools/cli/verify_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

namespace palpate::cli {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr double kBlockHalf = 0.02, kBlockRadius = 0.01,
                 kBlockDepth = 1e-4;      // m, of the block: 40 contact radii wide, 20 deep
constexpr double kBlockSpacing = 5e-3;    // m, between sites of the block
constexpr double kBlockTolerance = 1e-3;  // of the fit to the solved push
constexpr int kPressTicks = 400;          // of a press

/// The largest error on the block at a spacing (contact radii).
double allowed_on_block(double spacing) { return spacing < 1.25 ? 0.06 : spacing < 1.75 ? 0.02 : 0.01; }

/// The block as a scene, before its first solve.
pipeline::Pipeline block_pipeline(const ContactCase& c) {
  pipeline::Pipeline p;
  p.scene = c.scene;
  p.scene.sampling.spacing = p.scene.sampling.margin_spacing = kBlockSpacing;
  p.scene.sampling.depth = kBlockDepth;
  p.scene.response.tolerance = kBlockTolerance;
  p.body = c.body;
  p.tools = {c.tool};
  p.mesh = make_haptic_mesh(p.scene, p.body);
  pipeline::find_pairs(p);
  return p;
}

/// A response file of the block: the solved push of one tip alone at every site, and the block's compliance.
std::vector<std::byte> block_file(pipeline::Pipeline& p, const TwoTipsResult& solved,
                                  const ResponseCompliance& compliance) {
  // Between solved depths the force over depth^1.5 is linear.
  const auto force = [&](const Vector3d& deflection) {
    const double z = deflection.z();
    const auto& at = solved.pushed;
    const auto ratio = [&](std::size_t k) { return at[k][1] / std::pow(at[k][0], 1.5); };
    std::size_t k = 1;
    while (k + 1 < at.size() && at[k][0] < z) ++k;
    const double share = std::clamp((z - at[k - 1][0]) / (at[k][0] - at[k - 1][0]), 0.0, 1.0);
    return Vector3d(0, 0, std::pow(z, 1.5) * ((1 - share) * ratio(k - 1) + share * ratio(k)));
  };
  p.sources.solve_others = false;
  for (std::uint32_t pair = 0; pair < p.plan.pairs.size(); ++pair) {
    p.sources.given[pair].samples = fit::sample_along(bake_path(p.scene, p.plan.pairs[pair].depth), force);
  }
  return pipeline::fit_file(p, {}, pipeline::fit_settings(p), &compliance).bytes;
}

runtime::Pose to_pose(const Eigen::Isometry3d& pose) {
  runtime::Pose result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.rotation[3 * i + j] = pose.linear()(i, j);
  }
  result.translation = {pose.translation().x(), pose.translation().y(), pose.translation().z()};
  return result;
}

/// Forces of the runtime, in the contact's frame (x, y, n).
struct RuntimeForces {
  std::array<Vector3d, 2> together, alone;
  double share = 1;
};

RuntimeForces press_together(const runtime::View& view, const ContactCase& c, const BenchContact& contact,
                             const TwoTipsResult& solved) {
  const Eigen::Isometry3d first = touching_pose(c.tool.vertices.at(0), contact.frame);
  runtime::ToolSet<2> tools(view, {0, 0});
  std::array<runtime::Contact, 2> single{runtime::Contact(view, 0), runtime::Contact(view, 0)};
  RuntimeForces forces;
  const auto local = [&](const runtime::Vec3& f) { return contact.frame.to_local(Vector3d(f.x, f.y, f.z)); };
  for (int k = -kPressTicks / 20; k <= kPressTicks; ++k) {
    const double depth = contact.depth * k / kPressTicks;
    std::array<runtime::Pose, 2> poses;
    for (std::size_t i = 0; i < 2; ++i) {
      Eigen::Isometry3d pose = first;
      pose.translation() += (i == 0 ? Vector3d(0, 0, 0) : solved.beside) - depth * contact.frame.n;
      poses[i] = to_pose(pose);
    }
    const auto ticks = tools.tick(poses);
    for (std::size_t i = 0; i < 2; ++i) {
      forces.together[i] = local(ticks[i].force);
      forces.alone[i] = local(single[i].tick(poses[i]).force);
    }
  }
  forces.share = tools.joint()->share();
  return forces;
}

}  // namespace

void run_together(const TogetherCommand& command, const Globals& globals) {
  if (command.count != 2 || command.layout != "line") {
    throw Error(ExitCode::usage, "--together: " + std::to_string(command.count) + " tools in layout '" +
                                     command.layout + "'; allowed 2 in layout 'line'");
  }
  if (!command.report.empty()) check_writable(command.report);
  const bool block = command.scene.empty();
  if (!block) refuse_same({command.report}, files_of(read_scene(command.scene)));
  const ContactCase c =
      block ? block_contact(kBlockHalf, kBlockRadius, kBlockDepth, 0) : scene_contacts(command.scene, command.contacts);
  std::optional<ResponseInput> input;
  if (!block) {
    std::filesystem::path file = command.response;
    if (file.empty()) file = std::filesystem::path(command.scene).replace_extension(".palp");
    input.emplace(file.string());
    if (!input->view().has(layout::feature_compliance)) {
      throw Error(ExitCode::bad_input,
                  file.string() + ": has no compliance; add [compliance] to the scene and fit again");
    }
  }
  ContactCheckOptions options;
  options.spacings = command.spacings;
  options.threads = static_cast<unsigned>(globals.threads);
  options.stop = [] { return interrupted(); };
  options.progress = [&globals](std::size_t done, std::size_t total) {
    note(globals, "solved: " + std::to_string(done) + " of " + std::to_string(total));
  };
  const InterruptPolling polling;
  const std::vector<CheckedTips> all = check_two_tips(c.scene, c.body, c.tool, c.contacts, options);
  if (interrupted()) throw Interrupted("solves are not kept; run the command again");
  const auto usable = std::find_if(all.begin(), all.end(), [](const CheckedTips& t) { return t.result.usable; });
  if (usable == all.end()) {
    throw Error(ExitCode::numerical, "no solve is usable; the first: " + all.front().result.cause);
  }

  Json json{{"together", c.name}, {"machine", machine_name()}, {"contacts", Json::array()}};
  std::string text = c.name + ": two tips, solved without friction\n\n" +
                     "| contact | spacing, contact radii | one of two solved, N | sum is off by | runtime is off by "
                     "| along the normal | one alone is off by | share of C |\n|---|---|---|---|---|---|---|---|\n";
  std::vector<double> errors;
  std::string beyond;
  std::optional<pipeline::Pipeline> baked;
  ResponseCompliance compliance;
  if (block) {
    baked = block_pipeline(c);
    compliance = pipeline::compliance(*baked).file;
  }
  for (const CheckedTips& tips : all) {
    const TwoTipsResult& r = tips.result;
    if (!r.usable) {
      text += printed("| %zu | %.3g |", tips.contact, tips.spacing) + " refused: " + r.cause + " |\n";
      json["contacts"].push_back({{"spacing_radii", tips.spacing}, {"usable", false}, {"cause", r.cause}});
      continue;
    }
    // Each row of the block has the push of its own mesh, so that the mesh's error is not the coupling's.
    std::vector<std::byte> bytes;
    runtime::View view;
    if (block) {
      bytes = block_file(*baked, r, compliance);
      view = runtime::View::open(bytes.data(), bytes.size()).view;
    } else {
      view = input->view();
    }
    const RuntimeForces forces = press_together(view, c, c.contacts[tips.contact], r);
    double off = 0, normal = 0, sum = 0, alone = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      const double size = r.together[i].norm();
      off = std::max(off, (forces.together[i] - r.together[i]).norm() / size);
      normal = std::max(normal, std::abs(forces.together[i].z() - r.together[i].z()) / size);
      sum = std::max(sum, (r.alone[i] - r.together[i]).norm() / size);
      alone = std::max(alone, (forces.alone[i] - r.alone[i]).norm() / r.alone[i].norm());
    }
    errors.push_back(off);
    if (block && off > allowed_on_block(tips.spacing) && beyond.empty()) {
      beyond = printed("at %.3g contact radii the force is off by %.2f %%, allowed %.3g %%", tips.spacing, 100 * off,
                       100 * allowed_on_block(tips.spacing));
    }
    text += printed("| %zu | %.3g | %.4g | %.1f %% | %.2f %% | %.2f %% | %.2f %% | %.2f |\n", tips.contact,
                    tips.spacing, 0.5 * (r.together[0] + r.together[1]).z(), 100 * sum, 100 * off, 100 * normal,
                    100 * alone, forces.share);
    json["contacts"].push_back({{"contact", tips.contact},
                                {"spacing_radii", tips.spacing},
                                {"usable", true},
                                {"solved_N", {list(r.together[0]), list(r.together[1])}},
                                {"runtime_N", {list(forces.together[0]), list(forces.together[1])}},
                                {"sum_error", sum},
                                {"error", off},
                                {"normal_error", normal},
                                {"alone_error", alone},
                                {"share", forces.share}});
  }
  std::sort(errors.begin(), errors.end());
  const double p95 = errors[static_cast<std::size_t>(std::ceil(0.95 * double(errors.size()))) - 1];
  json["p95"] = p95;
  text += printed("\nforces of %zu pairs: 95th percentile off by %.2f %%\n", errors.size(), 100 * p95);
  if (!command.report.empty()) write_report(command.report, json);
  globals.json ? print_json(json) : print(text);
  if (!beyond.empty()) throw Error(ExitCode::tolerance, "--together: " + beyond);
  if (!block && p95 > command.max_p95) {
    throw Error(ExitCode::tolerance, printed("--together: the 95th percentile is off by %.2f %%, allowed %.3g %%",
                                             100 * p95, 100 * command.max_p95));
  }
}

}  // namespace palpate::cli
