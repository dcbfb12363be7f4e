// SPDX-License-Identifier: GPL-3.0-or-later
// palpate export: curves of a response file as CSV, its body with stiffness or friction on it as GLB and .vtu.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "formats/error.hpp"
#include "formats/file.hpp"
#include "formats/same_file.hpp"
#include "tools/command.hpp"
#include "tools/commands.hpp"
#include "tools/export.hpp"
#include "tools/output.hpp"
#include "tools/response_input.hpp"

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ExportArguments {
  std::string file, curves, glb, vtu, tool, field = "stiffness";
  std::uint32_t tool_vertex = 0;
  double depth = 0;  ///< m; 0: half the file's depth scale
  int points = 21;
};

/// The file has no such field: why.
[[noreturn]] void refuse_field(const runtime::View& view, const std::string& file, const std::string& field) {
  std::string cause = "the file is frictionless";
  if (field == "error") {
    cause = "the file holds no error of single responses";
    const Json provenance = Json::parse(std::string(view.provenance, view.provenance_size), nullptr, false);
    const Json fit = provenance.is_object() ? provenance.value("fit", Json()) : Json();
    const Json normal = fit.is_object() ? fit.value("normal", Json()) : Json();
    if (normal.is_object()) cause += ", only figures over all of them: " + normal.dump();
  }
  throw Error(ExitCode::bad_input, file + ": no field '" + field + "': " + cause);
}

void run_export(const ExportArguments& options, const Globals& globals) {
  if (options.curves.empty() && options.glb.empty() && options.vtu.empty()) {
    throw Error(ExitCode::usage, "nothing to write: export takes --curves, --glb or --vtu");
  }
  refuse_same({options.curves, options.glb, options.vtu}, {options.file});
  const ResponseInput input(options.file);
  const runtime::View& view = input.view();
  const double scale = view.meta->depth_scale, depth = options.depth > 0 ? options.depth : scale / 2;
  if (depth > scale) {
    throw Error(ExitCode::bad_input, options.file + ": was sampled to a depth of " + std::to_string(scale) +
                                         " m, --depth is " + std::to_string(depth) + " m");
  }
  const std::uint32_t tool = input.tool(options.tool);  // one that is not there is wrong with --curves alone, too
  Json result{{"file", options.file}, {"depth_m", depth}, {"written", Json::array()}};
  std::string text;
  if (!options.glb.empty() || !options.vtu.empty()) {
    const layout::ToolRecord& record = view.tools[tool];
    if (options.tool_vertex >= record.vertex_count) {
      throw Error(ExitCode::bad_input, options.file + ": the tool '" + record.name + "' has " +
                                           std::to_string(record.vertex_count) + " vertices, there is no number " +
                                           std::to_string(options.tool_vertex));
    }
    const SurfaceFields surface = body_fields(view, {tool, options.tool_vertex, depth});
    if (std::none_of(surface.fields.begin(), surface.fields.end(),
                     [&](const SurfaceField& f) { return f.name == options.field; })) {
      refuse_field(view, options.file, options.field);
    }
    if (!options.glb.empty()) write_glb(surface, options.field, options.glb);
    if (!options.vtu.empty()) write_vtu(surface, options.field, options.vtu);
    result["tool"] = record.name;
    result["tool_vertex"] = options.tool_vertex;
    result["vertices"] = surface.points.size();
    result["triangles"] = surface.triangles.size();
    result["shown"] = options.field;
    for (const SurfaceField& f : surface.fields) {
      const auto [low, high] = f.range();
      result["fields"][f.name] = {{"unit", f.unit}, {"least", low}, {"most", high}};
    }
    for (const std::string& path : {options.glb, options.vtu}) {
      if (path.empty()) continue;
      result["written"].push_back(path);
      const Json& range = result["fields"][options.field];
      char line[200];
      std::snprintf(line, sizeof line, ": %zu vertices, %s %.4g to %.4g %s\n", surface.points.size(),
                    options.field.c_str(), range["least"].get<double>(), range["most"].get<double>(),
                    range["unit"].get_ref<const std::string&>().c_str());
      text += path + line;
    }
  }
  if (!options.curves.empty()) {
    const CurveTable table = response_curves(view, depth, options.points);
    write_file(options.curves, table.csv);
    result["responses"] = table.responses;
    result["rows"] = table.rows;
    result["written"].push_back(options.curves);
    text += options.curves + ": " + std::to_string(table.rows) + " rows of " + std::to_string(table.responses) +
            " responses\n";
  }
  globals.json ? print_json(result) : print(text);
}

}  // namespace

void add_export(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<ExportArguments>();
  Command command(app, "export", "Writes a response file's curves as CSV, its body with a field as GLB or .vtu");
  command.option("file", options->file, "Response file (.palp)").required();
  command.option("--curves", options->curves, "CSV: force and friction limit of every response along pushes");
  command.option("--glb", options->glb, "GLB: the body, coloured, with the fields as vertex attributes");
  command.option("--vtu", options->vtu, "VTK unstructured grid: the body with the fields as point data");
  command
      .option("--field", options->field,
              "What the colours show: stiffness (N/m), force (N), friction (N, mu times the normal force), filled "
              "(share filled from neighbours), error (where a file holds it)")
      .check(one_of({"stiffness", "force", "friction", "filled", "error"}))
      .named("FIELD")
      .shows_default();
  command.option("--depth", options->depth, "m, of fields and tangential curves; default: half the depth scale")
      .check(number_in(1e-9, 1e3));
  command.option("--tool", options->tool, "Tool of the fields; default: the file's first");
  command.option("--tool-vertex", options->tool_vertex, "Its vertex that presses, by number").shows_default();
  command.option("--points", options->points, "Points of a curve").check(whole_in(2, 10000)).shows_default();
  command.runs([options, &globals] { run_export(*options, globals); });
}

}  // namespace palpate::cli
