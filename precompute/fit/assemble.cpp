// SPDX-License-Identifier: GPL-3.0-or-later
// The content of a response file from its parts.
#include "precompute/fit/assemble.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "formats/scene/scene.hpp"
#include "precompute/fit/laws/grasp_fit.hpp"
#include "precompute/tool/tool.hpp"

namespace palpate::fit {
namespace {

using Json = nlohmann::ordered_json;

ResponseTool response_tool(const tool::Tool& tool) {
  ResponseTool result;
  result.name = tool.name;
  result.kind = static_cast<layout::ToolKind>(tool.kind);
  result.radius = tool.scene.radius;
  const bool capsule = tool.scene.shape == ToolScene::Shape::capsule;
  const bool faceted = tool.scene.shape == ToolScene::Shape::punch || tool.kind == tool::ToolKind::mesh;
  if (!faceted) result.probe_radius = tool.scene.radius;
  if (capsule && tool.kind == tool::ToolKind::profile) result.axis_length = tool.scene.length;
  for (const tool::ToolVertex& v : tool.vertices) {
    result.vertices.push_back({v.name, to_triple(v.point), to_triple(v.normal), to_triple(v.tangent), v.meridian,
                               static_cast<std::uint32_t>(v.spins)});
  }
  for (const auto& p : tool.patches) {
    result.patches.push_back(
        {static_cast<std::uint32_t>(p[0]), static_cast<std::uint32_t>(p[1]), static_cast<std::uint32_t>(p[2])});
  }
  return result;
}

void add_body(ResponseFileContent& content, const mesh::ContactSurface& contact, const bake::Plan& plan) {
  // A site counts as held when no tool vertex may touch it for a support.
  std::vector<std::size_t> planned(plan.sites.size(), 0), at_support(plan.sites.size(), 0);
  for (const PairPlan& pair : plan.pairs) planned[pair.site] += pair.role == PairRole::hidden ? 0 : 1;
  for (const bake::SkippedPair& pair : plan.skipped)
    at_support[pair.site] += pair.reason == bake::SkipReason::support ? 1 : 0;
  for (std::size_t k = 0; k < plan.sites.size(); ++k) {
    const bake::PlanSite& site = plan.sites[k];
    ResponseSite out;
    out.normal = to_triple(site.frame.n);
    out.tangent = to_triple(site.frame.x);
    out.depth_limit = site.depth;
    if (site.held || (planned[k] == 0 && at_support[k] > 0)) out.flags |= layout::site_held;
    if (!site.selected) out.flags |= layout::site_outside;
    content.sites.push_back(out);
  }
  const auto corners = [](const std::array<std::int32_t, 3>& t) {
    return std::array<std::uint32_t, 3>{static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                                        static_cast<std::uint32_t>(t[2])};
  };
  for (const auto& t : contact.patches) content.patches.push_back(corners(t));
  content.subdivision = static_cast<std::uint32_t>(contact.weight_steps);
  for (const auto& p : contact.points) content.surface_vertices.push_back(to_triple(p));
  for (const mesh::ContactTriangle& t : contact.triangles) {
    content.surface_triangles.push_back({corners(t.vertices), static_cast<std::uint32_t>(t.patch), t.grid});
  }
}

Json figures(const ErrorFigures& f) {
  return {
      {"samples", f.samples}, {"median", f.median}, {"p95", f.p95}, {"worst", f.worst}, {"worst_pair", f.worst_pair}};
}

/// Adds the sources of responses of a scene in which not everything is solved.
void add_sources(Json& json, const bake::Plan& plan, const FitReport& report, const PairSources& sources) {
  if (sources.external.empty()) return;
  Json& to = json["sources"];
  to["scene"] = to_hex(sources.text);
  to["analytic"] = report.analytic;
  if (report.analytic > 0) to["analytic_fit"] = figures(report.laws);
  if (report.recorded.empty()) return;
  to["recordings"] = Json::array();
  for (const Hash128& recording : sources.recordings) to["recordings"].push_back(to_hex(recording));
  to["measured"] = Json::array();
  for (const RecordedFigures& f : report.recorded) {
    const PairPlan& pair = plan.pairs[f.pair];
    to["measured"].push_back({{"site", pair.site},
                              {"tool", pair.tool},
                              {"tool_vertex", pair.tool_vertex},
                              {"rows", f.rows},
                              {"outliers", f.outliers.size()},
                              {"residual_rms_N", f.rms},
                              {"residual_worst_N", f.worst},
                              {"depth_m", f.depth}});
  }
}

std::string provenance(const Scene& scene, const bake::Plan& plan, const Hash128& manifest,
                       const FittedResponses& fitted, const PairSources& sources) {
  const FitReport& report = fitted.report;
  Json json;
  json["scene"] = scene.name;
  json["units"] = "m, N, Pa";
  json["inputs"] = {{"solver", plan.inputs.solver},     {"scene", to_hex(hash128(canonical_text(scene)))},
                    {"body", to_hex(plan.inputs.body)}, {"haptic_mesh", to_hex(plan.inputs.haptic_mesh)},
                    {"tools", Json::array()},           {"manifest", to_hex(manifest)}};
  for (const Hash128& tool : plan.inputs.tools) json["inputs"]["tools"].push_back(to_hex(tool));
  json["material"] = {{"young", scene.material.young}, {"poisson", scene.material.poisson}};
  json["regions"] = Json::array();
  for (const RegionScene& region : scene.regions) {
    json["regions"].push_back(
        {{"name", region.name}, {"young", region.material.young}, {"poisson", region.material.poisson}});
  }
  if (scene.prestress.any()) {
    const PrestressScene& p = scene.prestress;
    json["prestress"] = {{"gravity", to_triple(p.gravity)},
                         {"density", p.density},
                         {"pressure", p.pressure},
                         {"stretch", to_triple(p.stretch)}};
  }
  json["friction"] = scene.friction;
  json["sampling"] = {{"spacing", scene.sampling.spacing},
                      {"depth", scene.sampling.depth},
                      {"depth_fraction", scene.sampling.depth_fraction},
                      {"normal_points", scene.sampling.normal_points},
                      {"tangential_depths", scene.sampling.tangential_depths},
                      {"tangential_directions", scene.sampling.tangential_directions},
                      {"tangential_points", scene.sampling.tangential_points}};
  if (scene.friction > 0) {
    const bool solved = scene.sampling.friction_limit == SamplingScene::FrictionLimit::solved;
    json["sampling"]["friction_limit"] = solved ? "solved" : "estimated";
  }
  const SurfaceFigures& surface = report.surface;
  json["contact_surface"] = {{"tolerance_m", surface.tolerance}, {"distance_m", surface.distance}};
  if (!surface.fault.empty()) json["contact_surface"]["fault"] = surface.fault;
  json["solver"] = {{"mesh_size", scene.solver.mesh_size}, {"growth", scene.solver.growth}};
  json["pairs"] = {
      {"planned", report.planned},         {"accepted", report.accepted},   {"refused", report.refused},
      {"filled", report.filled},           {"support", report.support},     {"outside", report.outside},
      {"unreachable", report.unreachable}, {"shortened", report.shortened}, {"support_area_share", plan.support_share}};
  if (report.carried > 0) {
    json["pairs"]["full"] = report.full;
    json["pairs"]["carried"] = report.carried;
  }
  for (const Refusals& kind : report.refusals) {
    json["refusals"].push_back({{"pairs", kind.pairs}, {"area_share", kind.area_share}, {"example", kind.example}});
  }
  json["fit"] = {{"error", "|fit - solved| / max(|solved|, 2 % of the pair's peak)"},
                 {"normal", figures(report.normal)}};
  if (report.friction) json["fit"]["tangential"] = figures(report.tangential);
  if (!report.softenings.empty()) {
    json["fit"]["slip_softening"] = {{"median", report.softenings[report.softenings.size() / 2]},
                                     {"largest", report.softenings.back()}};
  }
  if (report.grasp) json["fit"]["grasped"] = figures(report.grasped);
  if (report.turn) json["fit"]["turned"] = figures(report.turned);
  if (report.friction) json["fit"]["paths"] = figures(report.paths);
  if (report.left_out.samples > 0) json["fit"]["carried_tangential"] = figures(report.left_out);
  if (report.sampling) {
    const bake::SamplingEstimate& s = *report.sampling;
    json["sampling"]["hidden"] = {{"rounds", s.rounds},  {"places", s.places}, {"median", s.median},
                                  {"p95", s.hidden_p95}, {"worst", s.worst},   {"worst_at", to_triple(s.worst_at)}};
    json["sampling"]["edges_p95"] = s.edges_p95;
    json["sampling"]["expected_p95"] = expected_p95(report);
  }
  const SampleFigures& held = report.held_out;
  json["fit"]["held_out"] = {
      {"samples", held.samples}, {"median", held.median}, {"p95", held.p95}, {"worst", held.worst}};
  const response::Degrees& d = fitted.scales.degrees;
  json["degrees"] = {{"normal", d.normal}, {"bias", d.bias}, {"stiffness", d.stiffness}, {"friction", d.friction}};
  add_sources(json, plan, report, sources);
  // Names may hold bytes that are not UTF-8. These are replaced.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

ResponseFileContent assemble_response(const Scene& scene, const std::vector<tool::Tool>& tools,
                                      const mesh::ContactSurface& contact, const bake::Plan& plan,
                                      const Hash128& manifest, const FittedResponses& fitted,
                                      const PairSources& sources) {
  ResponseFileContent content;
  content.depth_scale = fitted.scales.depth;
  content.tangential_scale = fitted.scales.tangential;
  content.degrees = fitted.scales.degrees;
  content.coef_bits = static_cast<std::uint32_t>(fitted.scales.bits);
  content.slip_softening = !fitted.report.softenings.empty();
  content.bonded_coefs = fitted.report.grasp ? kGraspCoefs : 0;
  content.has_bonded_torque = fitted.report.turn;
  add_body(content, contact, plan);
  for (const tool::Tool& tool : tools) content.tools.push_back(response_tool(tool));
  content.responses = fitted.responses;
  content.provenance = provenance(scene, plan, manifest, fitted, sources);
  const bool search = scene.response.search == ResponseScene::Search::bvh ||
                      (scene.response.search == ResponseScene::Search::automatic &&
                       content.surface_triangles.size() > kSearchThreshold);
  if (search) add_search(content);
  return content;
}

}  // namespace palpate::fit
