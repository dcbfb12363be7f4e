// SPDX-License-Identifier: GPL-3.0-or-later
// palpate inspect: what a response file holds, what was left out, and what each part costs in bytes.
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/response_input.hpp"
#include "tools/inspect/inspect.hpp"

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

/// The shape as a scene names it.
const char* shape_name(const layout::ToolRecord& tool) {
  if (tool.kind == static_cast<std::uint32_t>(layout::ToolKind::mesh)) return "mesh";
  // Among the round shapes a punch alone has no radius about its axis, and a capsule alone has an axis with a length.
  if (!(tool.probe_radius > 0)) return "punch";
  return tool.axis_length > 0 ? "capsule" : "sphere";
}

constexpr std::uint32_t kSources[] = {layout::response_solved, layout::response_filled, layout::response_measured,
                                      layout::response_analytic};

struct Shares {
  std::map<std::uint32_t, std::size_t> responses;  ///< by layout::ResponseFlag
  std::size_t held = 0, outside = 0;
  [[nodiscard]] std::size_t of(std::uint32_t source) const {
    const auto at = responses.find(source);
    return at == responses.end() ? 0 : at->second;
  }
};

Shares count_shares(const runtime::View& v) {
  Shares s;
  for (std::uint32_t i = 0; i < v.meta->response_count; ++i) {
    ++s.responses[v.response_head(i).flags];
  }
  for (std::uint32_t i = 0; i < v.meta->site_count; ++i) {
    s.held += (v.sites[i].flags & layout::site_held) != 0 ? 1 : 0;
    s.outside += (v.sites[i].flags & layout::site_outside) != 0 ? 1 : 0;
  }
  return s;
}

/// Points of a tool by which it touches, and most spins that one of them has.
struct ToolPoints {
  std::uint32_t points = 0, spins = 1;
};

ToolPoints count_points(const runtime::View& v, const layout::ToolRecord& tool) {
  if (v.spins == nullptr) return {tool.vertex_count, 1};
  ToolPoints counted;
  for (std::uint32_t k = 0; k < tool.vertex_count; ++k) {
    const std::uint32_t spins = v.spins[tool.first_vertex + k];
    counted.points += spins > 0 ? 1 : 0;
    counted.spins = std::max(counted.spins, spins);
  }
  return counted;
}

Json tools_json(const runtime::View& v) {
  Json tools = Json::array();
  for (std::uint32_t i = 0; i < v.meta->tool_count; ++i) {
    const layout::ToolRecord& t = v.tools[i];
    tools.push_back({{"name", t.name}, {"kind", shape_name(t)}, {"radius", t.radius}, {"vertices", t.vertex_count}});
    const ToolPoints counted = count_points(v, t);
    if (counted.spins > 1) {
      tools.back()["vertices"] = counted.points;
      tools.back()["spins"] = counted.spins;
    }
  }
  return tools;
}

}  // namespace

const std::vector<FeatureName>& feature_names() {
  static const std::vector<FeatureName> names{
      {layout::feature_tangential_bias, "tangential_bias", "a normal indentation has no tangential force"},
      {layout::feature_friction, "friction", "frictionless: contacts slip without tangential force"},
      {layout::feature_slip_softening, "slip_softening", "a contact that slips keeps its normal force"},
      {layout::feature_tool_patches, "tool_patches", "each tool touches by one vertex only"},
      {layout::feature_bonded, "bonded", "no tool bonds to the body: a pull ends the contact"},
      {layout::feature_bonded_torque, "bonded_torque", "rotations of a bonded tool have no torque"},
      {layout::feature_spin, "spin", "the rotation of a tool about the contact normal has no influence"},
      {layout::feature_compliance, "compliance", "contacts near each other do not feel each other: forces are added"},
      {layout::feature_search, "search", "no search tree: the contact surface is searched triangle by triangle"}};
  return names;
}

Json contents_of(const runtime::View& v, const std::string& file) {
  const layout::Meta& m = *v.meta;
  const Shares s = count_shares(v);
  Json json{{"file", file}, {"bytes", v.size}, {"version", v.header().version}};
  json["features"] = Json::array();
  json["left_out"] = Json::array();
  for (const FeatureName& f : feature_names())
    json[(v.features & f.bit) != 0 ? "features" : "left_out"].push_back(f.name);
  json["sections"] = Json::array();
  for (std::uint32_t i = 0; i < v.header().section_count; ++i) {
    const layout::SectionEntry& e = v.sections()[i];
    json["sections"].push_back({{"name", layout::section_name(e.id)}, {"bytes", e.size}, {"count", e.count}});
  }
  json["depth_scale"] = m.depth_scale;
  json["tangential_scale"] = m.tangential_scale;
  json["sites"] = m.site_count;
  json["sites_held"] = s.held;
  json["sites_outside"] = s.outside;
  json["patches"] = m.patch_count;
  json["weight_steps"] = m.subdivision;
  json["surface_vertices"] = m.vertex_count;
  json["surface_triangles"] = m.triangle_count;
  json["tools"] = tools_json(v);
  json["responses"] = m.response_count;
  if (v.compliance != nullptr) {
    json["compliance"] = {{"modes", v.compliance->modes},
                          {"negative_modes", v.compliance->negative},
                          {"poisson", v.compliance->poisson},
                          {"rounding", v.compliance->rounding},
                          {"stiffening", v.compliance->stiffening}};
  }
  for (const std::uint32_t source : kSources) {
    json[std::string("responses_") + layout::source_name(source)] = s.of(source);
  }
  json["bytes_per_response"] = bytes_per_response(v);
  json["coefficients"] = response::count(response::degrees(m));
  json["coefficient_bits"] = m.coef_bits;
  json["degrees"] = {{"normal", m.normal_degree},
                     {"bias", m.bias_degree},
                     {"stiffness", m.stiffness_degree},
                     {"friction", m.friction_degree}};
  const std::string text(v.provenance, v.provenance_size);
  const Json provenance = Json::parse(text, nullptr, false);
  json["provenance"] = provenance.is_discarded() ? Json(text) : provenance;
  return json;
}

namespace {

template <class... Values>
void append(std::string& text, const char* format, Values... values) {
  char line[300];
  std::snprintf(line, sizeof line, format, values...);
  text += line;
}

std::string as_text(const runtime::View& v, const Json& json) {
  const layout::Meta& m = *v.meta;
  std::string text;
  append(text, "version %u, %zu bytes\n\n", v.header().version, v.size);
  for (std::uint32_t i = 0; i < v.header().section_count; ++i) {
    const layout::SectionEntry& e = v.sections()[i];
    append(text, "  %-18s %12llu bytes %5.1f %%  %10llu x %u\n", layout::section_name(e.id),
           static_cast<unsigned long long>(e.size), 100.0 * static_cast<double>(e.size) / static_cast<double>(v.size),
           static_cast<unsigned long long>(e.count), e.element_size);
  }
  text += "\n";
  for (const FeatureName& f : feature_names()) {
    const bool there = (v.features & f.bit) != 0;
    append(text, "%-16s %s%s%s\n", f.name, there ? "present" : "left out: ", there ? "" : f.without, "");
  }
  const Shares s = count_shares(v);
  append(text, "\n%s (%zu held, %zu outside the sampled region), %s, %s\n", counted(m.site_count, "site").c_str(),
         s.held, s.outside, counted(json["patches"].get<std::size_t>(), "patch", "patches").c_str(),
         counted(m.triangle_count, "contact triangle").c_str());
  append(text, "%s of %.0f bytes: %zu solved, %zu measured, %zu analytic, %zu filled from neighbours (%.2f %%)\n",
         counted(m.response_count, "response").c_str(), bytes_per_response(v), s.of(layout::response_solved),
         s.of(layout::response_measured), s.of(layout::response_analytic), s.of(layout::response_filled),
         100.0 * static_cast<double>(s.of(layout::response_filled)) / m.response_count);
  const Json& provenance = json["provenance"];
  const auto at = Json::json_pointer("/pairs/carried");
  if (provenance.is_object() && provenance.contains(at)) {
    append(text, "of these solved %d in full, %d carried from these to normal indentations\n",
           provenance["pairs"].value("full", 0), provenance["pairs"].value("carried", 0));
  }
  append(text, "%d coefficients of %u bits; degrees: normal %u, bias %u, stiffness %u, friction %u\n",
         response::count(response::degrees(m)), m.coef_bits, m.normal_degree, m.bias_degree, m.stiffness_degree,
         m.friction_degree);
  append(text, "depth scale %.4g mm, tangential scale %.4g mm\n", 1e3 * m.depth_scale, 1e3 * m.tangential_scale);
  if (v.compliance != nullptr) {
    append(
        text,
        "compliance: half-space of Poisson ratio %.4g, rounded at %.3g mm, and %u modes (%u negative); stiffening with "
        "depth %.3g\n",
        v.compliance->poisson, 1e3 * v.compliance->rounding, v.compliance->modes, v.compliance->negative,
        v.compliance->stiffening);
  }
  for (std::uint32_t i = 0; i < m.tool_count; ++i) {
    const layout::ToolRecord& t = v.tools[i];
    const ToolPoints touching = count_points(v, t);
    append(text, "tool '%s': %s, radius %.4g mm, %s", t.name, shape_name(t), 1e3 * static_cast<double>(t.radius),
           counted(touching.points, "contact vertex", "contact vertices").c_str());
    if (touching.spins > 1) append(text, ", up to %u spins each", touching.spins);
    text += "\n";
  }
  return text + "provenance: " + json["provenance"].dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

void add_inspect(CLI::App& app, Globals& globals) {
  auto file = std::make_shared<std::string>();
  Command command(app, "inspect", "Lists what a response file holds and what was left out");
  command.option("file", *file, "Response file (.palp)").required();
  command.runs([file, &globals] {
    const ResponseInput input(*file);
    const Json json = contents_of(input.view(), *file);
    globals.json ? print_json(json) : print(as_text(input.view(), json));
  });
}

}  // namespace palpate::cli
