// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/pipeline/sources.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "formats/io/error.hpp"
#include "precompute/bake/tool_lookup.hpp"
#include "precompute/fit/closed_form.hpp"
#include "precompute/pipeline/recorded_pairs.hpp"

namespace palpate::pipeline {
namespace {

using Eigen::Vector3d;

constexpr double kLayerDepth = 0.5;  // of the layer's thickness

/// One law of the scene at the pairs that it holds for.
class AppliedLaw {
public:
  AppliedLaw(const Scene& scene, const AnalyticScene& law, std::size_t number, const std::vector<tool::Tool>& tools)
      : scene_(scene), law_(law), where_(scene.file.string() + ": analytic " + std::to_string(number + 1)) {
    if (!law.tool.empty()) only_ = bake::find_tool(tools, law.tool, where_);
    if (law.law == AnalyticScene::Law::layer && scene.friction > 0) {
      throw Error(ExitCode::bad_input,
                  where_ + ": a layer's tangential response has no closed form: no friction with it");
    }
  }

  [[nodiscard]] bool holds(const PairPlan& pair, const Body& body) const {
    const Vector3d& at = pair.frame.origin;
    if (only_ && *only_ != pair.tool) return false;
    if (law_.within_box && !((at.array() >= law_.within_box->first.array()).all() &&
                             (at.array() <= law_.within_box->second.array()).all()))
      return false;
    if (!law_.sites.empty() && !std::binary_search(law_.sites.begin(), law_.sites.end(), static_cast<int>(pair.site)))
      return false;
    if (law_.mesh.empty()) return true;
    const Surface& surface = body.query->surface();
    const auto part = surface.parts[static_cast<std::size_t>(body.query->closest(at).triangle)];
    return surface.part_names[static_cast<std::size_t>(part)] == law_.mesh;
  }

  [[nodiscard]] fit::ExternalSamples samples(const PairPlan& pair, const tool::Tool& tool, double wall) const {
    bake::refuse_grasps(tool, where_);
    fit::ExternalSamples external;
    external.samples = fit::sample_law(form(pair, tool, wall), solve::bake_path(scene_, pair.depth));
    return external;
  }

  void check_sites(std::size_t count) const {
    if (law_.sites.empty() || static_cast<std::size_t>(law_.sites.back()) < count) return;
    throw Error(ExitCode::bad_input, scene_.file.string() + ":" + std::to_string(law_.sites_line) +
                                         ": analytic.sites: there is no site " + std::to_string(law_.sites.back()) +
                                         "; the body has " + std::to_string(count) + ", from 0");
  }

  void check_used(bool used) const {
    if (used) return;
    throw Error(ExitCode::bad_input, where_ + ": holds at no site that a tool touches, or after another law");
  }

private:
  using Form = AnalyticScene::Law;

  [[nodiscard]] fit::ClosedForm form(const PairPlan& pair, const tool::Tool& tool, double wall) const {
    const tool::ToolVertex& vertex = tool.vertices[pair.tool_vertex];
    const ToolScene::Shape shape = tool.scene.shape;
    const bool taper = shape == ToolScene::Shape::cone || shape == ToolScene::Shape::needle;
    const bool ball = shape == ToolScene::Shape::sphere || (shape == ToolScene::Shape::capsule && !tool.scene.whole);
    const bool flat = shape == ToolScene::Shape::punch && vertex.flat_radius > 0;
    require(tool, law_.law == Form::spring || (law_.law == Form::cone      ? taper
                                               : law_.law == Form::punch   ? flat
                                               : law_.law == Form::winkler ? ball || flat
                                                                           : ball));
    fit::ClosedForm form;
    form.law = law_.law;
    form.young = law_.young.value_or(scene_.material.young);
    form.poisson = law_.law == Form::layer ? 0.5 : law_.poisson.value_or(scene_.material.poisson);
    form.radius = flat ? vertex.flat_radius : vertex.curvature_radius;
    form.flat = flat;
    form.slope = vertex.cone_slope;
    form.thickness = law_.thickness > 0 ? law_.thickness : wall;
    form.stiffness = law_.stiffness;
    form.tangential = law_.tangential_stiffness > 0 ? law_.tangential_stiffness : law_.stiffness;
    check_depth(pair.depth, form, ball, tool);
    return form;
  }

  /// Throws where the law does not hold as deep as is sampled.
  void check_depth(double depth, const fit::ClosedForm& form, bool ball, const tool::Tool& tool) const {
    const auto refuse = [&](const char* range, double limit) {
      char text[160];
      std::snprintf(text, sizeof text, ": is for depths %s of %.3g mm, not %.3g mm", range, 1e3 * limit, 1e3 * depth);
      throw Error(ExitCode::bad_input, where_ + text);
    };
    if (ball && law_.law != Form::spring && depth > form.radius) refuse("up to the tip's radius", form.radius);
    if (law_.law == Form::cone && depth < tool.scene.radius) refuse("from the tip's radius", tool.scene.radius);
    if (law_.law == Form::layer && law_.thickness > 0 && depth > kLayerDepth * law_.thickness) {
      refuse("up to half the layer's thickness", law_.thickness);
    }
  }

  void require(const tool::Tool& tool, bool fits) const {
    if (fits) return;
    throw Error(ExitCode::bad_input, where_ + ": the law is not for the shape of the tool '" + tool.name +
                                         "' (hertz, layer: sphere, tip of a capsule; punch: punch; cone: cone, "
                                         "needle; winkler: sphere, punch; spring: any)");
  }

  const Scene& scene_;
  const AnalyticScene& law_;
  std::string where_;
  std::optional<std::uint32_t> only_;
};

/// Throws unless every tool vertex has a pair that its other sites can be filled from.
void check_fillable(const Scene& scene, const std::vector<tool::Tool>& tools, const bake::Plan& plan,
                    const fit::PairSources& sources) {
  const std::string where = scene.file.string() + ": sources.rest = \"filled\"";
  if (sources.external.empty()) {
    throw Error(ExitCode::bad_input, where +
                                         " needs a recording ([[measured]], --measured) or a law ([[analytic]]) to "
                                         "fill from");
  }
  std::set<std::pair<std::uint32_t, std::uint32_t>> given;  // tool, tool vertex
  for (const auto& [pair, unused] : sources.external)
    given.emplace(plan.pairs[pair].tool, plan.pairs[pair].tool_vertex);
  for (std::uint32_t tool = 0; tool < tools.size(); ++tool) {
    for (std::uint32_t vertex = 0; vertex < tools[tool].vertices.size(); ++vertex) {
      if (given.count({tool, vertex}) > 0) continue;
      throw Error(ExitCode::bad_input, where + " has nothing to fill from for contact vertex " +
                                           std::to_string(vertex) + " of the tool '" + tools[tool].name +
                                           "': it needs a recording or a law at one site at least");
    }
  }
}

}  // namespace

fit::PairSources find_sources(const Scene& scene, const SceneSources& wanted, const Body& body,
                              const std::vector<tool::Tool>& tools, const sites::HapticMesh& mesh,
                              const bake::Plan& plan) {
  fit::PairSources sources;
  sources.solve_others = wanted.rest == SceneSources::Rest::solved;
  sources.text = hash128(canonical_text(wanted));
  read_recordings(scene, wanted.measured, body, tools, plan, sources);
  for (std::size_t number = 0; number < wanted.analytic.size(); ++number) {
    const AppliedLaw law(scene, wanted.analytic[number], number, tools);
    law.check_sites(plan.sites.size());
    bool used = false;
    for (std::uint32_t k = 0; k < plan.pairs.size(); ++k) {
      const PairPlan& pair = plan.pairs[k];
      if (sources.external.count(k) > 0 || !law.holds(pair, body)) continue;
      sources.external[k] = law.samples(pair, tools[pair.tool], mesh.thickness[pair.site]);
      used = true;
    }
    law.check_used(used);
  }
  if (!sources.solve_others) check_fillable(scene, tools, plan, sources);
  return sources;
}

}  // namespace palpate::pipeline
