// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/verify_shape.hpp"

#include "formats/io/error.hpp"
#include "palpate/format/open.hpp"
#include "palpate/shared/dent.hpp"
#include "precompute/bake/reach.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/verify_checks.hpp"
#include "tools/verify/press_together.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

namespace palpate::cli {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr double kUnderTool = 1.5, kFarthest = 8;  // contact radii: ends of the two bands that are judged
constexpr std::size_t kDrawn = 20000;              // vertices of the mesh that is timed
constexpr double kBands[] = {0, 1, kUnderTool, 2, 3, kFarthest};  // contact radii

runtime::Vec3 to_vec(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// The contacts of the runtime at the end of a press.
template <int Count>
runtime::Dents dents_of(const runtime::View& view, const ContactCase& c, const verify::CheckedTogether& solved) {
  runtime::ToolSet<Count> tools(view, {});
  runtime::Dents dents;
  press_together(tools, c, solved, 0, [&](const auto& poses, const auto& ticks) {
    dents = {};
    for (std::size_t i = 0; i < poses.size(); ++i) dents.add(view, ticks[i], poses[i], 0);
  });
  return dents;
}

/// Errors of the drawn surface (shares of the depth), by distance from the nearest contact.
struct ShapeErrors {
  std::array<std::vector<double>, std::size(kBands) - 1> band;
  double seconds = 0;  ///< of a mesh of kDrawn vertices with these contacts

  void add(const ShapeErrors& other) {
    for (std::size_t b = 0; b < band.size(); ++b)
      band[b].insert(band[b].end(), other.band[b].begin(), other.band[b].end());
    seconds = std::max(seconds, other.seconds);
  }
  [[nodiscard]] double quantile(double from, double to, double share) const {
    std::vector<double> all;
    for (std::size_t b = 0; b < band.size(); ++b) {
      if (kBands[b] >= from && kBands[b + 1] <= to) all.insert(all.end(), band[b].begin(), band[b].end());
    }
    if (all.empty()) return 0;
    std::sort(all.begin(), all.end());
    return all[static_cast<std::size_t>(std::ceil(share * double(all.size() - 1)))];
  }
};

ShapeErrors shape_errors(const runtime::View& view, const ContactCase& c, const verify::CheckedTogether& solved) {
  const double depth = c.contacts[solved.contact].depth, radius = tool::contact_radius(c.tool.vertices.at(0), depth);
  const runtime::Dents dents = solved.places.size() == 1 ? dents_of<1>(view, c, solved) : dents_of<2>(view, c, solved);
  const std::vector<solve::SurfaceNode>& nodes = solved.result.surface;
  std::vector<runtime::Vec3> rest;
  for (const solve::SurfaceNode& node : nodes) rest.push_back(to_vec(node.rest));
  std::vector<runtime::Vec3> moved(rest.size());
  runtime::Dent dent(view);
  dent.bind(rest.data(), rest.size());
  dent.apply(dents, moved.data());
  ShapeErrors errors;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    double distance = std::numeric_limits<double>::infinity();
    for (const ContactFrame& place : solved.places) {
      distance = std::min(distance, (nodes[k].rest - place.origin).norm() / radius);
    }
    for (std::size_t b = 0; b < errors.band.size(); ++b) {
      if (distance >= kBands[b] && distance < kBands[b + 1]) {
        errors.band[b].push_back(length(moved[k] - to_vec(nodes[k].moved)) / depth);
      }
    }
  }
  while (rest.size() < kDrawn) rest.push_back(rest[rest.size() - nodes.size()]);
  rest.resize(kDrawn);
  moved.resize(kDrawn);
  dent.bind(rest.data(), rest.size());
  const auto begin = std::chrono::steady_clock::now();
  dent.apply(dents, moved.data());
  errors.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return errors;
}

/// The same with a file that is made for this solve of the block.
ShapeErrors block_errors(std::optional<BlockResponse>& block, const ContactCase& c,
                         const verify::CheckedTogether& solved) {
  if (!block) block.emplace(c);
  const std::vector<std::byte> bytes = block->file(solved.result);
  return shape_errors(runtime::View::open(bytes.data(), bytes.size()).view, c, solved);
}

}  // namespace

void run_shape(const ShapeCommand& command, const Globals& globals) {
  std::unique_ptr<ResponseInput> input;
  if (!command.scene.empty()) input = response_with_compliance(command.scene, command.response);
  const ContactCase c = command.scene.empty() ? block_contact(kBlockHalf, kBlockRadius, kBlockDepth, 0)
                                              : scene_contacts(command.scene, command.contacts);
  std::optional<BlockResponse> block;
  Json json{{"shape", c.name}, {"machine", machine_name()}, {"tools", Json::array()}};
  std::string text = c.name +
                     ": drawn surface against the solved one, error in % of the depth\n\n"
                     "| tools | solves | nodes | under the tool, worst | 1 to 1.5 radii, worst | 1.5 to 2, 95 % | 2 to "
                     "3, 95 % | 3 to 8, 95 % | 20 000 vertices, ms |\n|---|---|---|---|---|---|---|---|---|\n";
  ShapeErrors every;
  std::string cause;
  std::size_t usable = 0;
  for (const int count : {1, 2}) {
    verify::ContactCheckOptions options;
    options.count = count;
    options.spacings = count == 1 ? std::vector<double>{1} : std::vector<double>{2, 4};
    options.sticking = c.scene.friction > 0;
    options.touchable = bake::can_be_pressed;
    options.threads = static_cast<unsigned>(globals.threads);
    ShapeErrors all;
    std::size_t solves = 0, nodes = 0;
    for (const verify::CheckedTogether& solved : verify::check_together(c.scene, c.body, c.tool, c.contacts, options)) {
      if (!solved.result.usable) {
        if (cause.empty()) cause = solved.result.cause;
        continue;
      }
      all.add(input ? shape_errors(input->view(), c, solved) : block_errors(block, c, solved));
      ++solves;
    }
    for (const auto& band : all.band) nodes += band.size();
    usable += solves;
    every.add(all);
    text += printed("| %d | %zu | %zu | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f |\n", count, solves, nodes,
                    100 * all.quantile(0, 1, 1), 100 * all.quantile(1, kUnderTool, 1),
                    100 * all.quantile(kUnderTool, 2, 0.95), 100 * all.quantile(2, 3, 0.95),
                    100 * all.quantile(3, kFarthest, 0.95), 1e3 * all.seconds);
    json["tools"].push_back({{"count", count},
                             {"solves", solves},
                             {"nodes", nodes},
                             {"worst_under", all.quantile(0, kUnderTool, 1)},
                             {"p95_beyond", all.quantile(kUnderTool, kFarthest, 0.95)},
                             {"seconds_20000", all.seconds}});
  }
  if (usable == 0) throw Error(ExitCode::numerical, "no solve is usable; the first: " + cause);
  const double worst = every.quantile(0, kUnderTool, 1), p95 = every.quantile(kUnderTool, kFarthest, 0.95);
  json["worst_under"] = worst;
  json["p95_beyond"] = p95;
  text += printed(
      "\nbeyond 1.5 contact radii 95 %% are within %.2f %% of the depth; within them the worst is off by %.2f %%\n",
      100 * p95, 100 * worst);
  if (!command.report.empty()) write_report(command.report, json);
  globals.json ? print_json(json) : print(text);
  if (p95 > command.max_p95 || worst > command.max_worst) {
    throw Error(
        ExitCode::tolerance,
        printed("--shape: the drawn surface is off by %.2f %% and %.2f %% of the depth, allowed %.3g and %.3g %%",
                100 * p95, 100 * worst, 100 * command.max_p95, 100 * command.max_worst));
  }
}

}  // namespace palpate::cli
