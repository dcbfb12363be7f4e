// SPDX-License-Identifier: GPL-3.0-or-later
// palpate export: curves of a response file as CSV, its body with stiffness or friction on it as GLB, .vtu and PNG; one
// solved contact of a scene with its stresses as .vtu.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "formats/fields/volume_vtu.hpp"
#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "formats/io/same_file.hpp"
#include "precompute/pipeline/pipeline.hpp"
#include "precompute/solve/pair/solved_fields.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/response_input.hpp"
#include "tools/inspect/export.hpp"
#include "tools/inspect/picture.hpp"

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ExportArguments {
  std::string file, curves, glb, vtu, png, solved, tool, field = "stiffness";
  PictureOptions picture;
  std::uint32_t tool_vertex = 0;
  double depth = 0;  ///< m; 0: half the file's depth scale
  int points = 21, contact = 0;
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

/// Solves one contact of a scene's plan and writes its mesh with displacement and stress.
void run_solved(const ExportArguments& options, const Globals& globals) {
  check_writable(options.solved);
  refuse_same({options.solved}, pipeline::files_of(options.file));
  const pipeline::Pipeline p = pipeline::prepare(options.file);
  const bake::Plan plan = bake::make_plan(p.scene, p.body, p.mesh, p.tools);
  if (std::size_t(options.contact) >= plan.pairs.size()) {
    throw Error(ExitCode::bad_input, options.file + ": its plan has " + std::to_string(plan.pairs.size()) +
                                         " contacts; allowed: --contact 0 to " + std::to_string(plan.pairs.size() - 1));
  }
  const PairPlan& pair = plan.pairs[std::size_t(options.contact)];
  const tool::Tool& tool = p.tools[pair.tool];
  const double depth = options.depth > 0 ? options.depth : pair.depth;
  solve::PairPath path = solve::bake_path(p.scene, depth);
  path.tangential_directions = path.slip_points = 0;
  solve::PairOptions solve = solve::pair_options(p.scene);
  VolumeFields fields;
  const Body& body = p.body.stress_free ? *p.body.stress_free : p.body;
  solve.watch = [&](const mesh::TetMesh& mesh, const Eigen::VectorXd& x, double reached) {
    if (reached < depth) return;
    fields = solve::solved_fields(body, mesh, x);
  };
  const PairResult result = solve::solve_pair({p.body, tool, tool.vertices[pair.tool_vertex], pair.frame}, path, solve);
  if (!result.outcome.accepted || result.samples.empty() || fields.tets.empty()) {
    throw Error(ExitCode::numerical,
                options.file + ": contact " + std::to_string(options.contact) + " is refused: " + result.outcome.cause);
  }
  const double force = result.samples.back().force.norm();
  fields.numbers = {{"depth_m", depth}, {"force_n", force}};
  write_volume_vtu(fields, options.solved);
  double most = 0;
  for (const auto& s : fields.stress) most = std::max(most, von_mises(s));
  if (globals.json) {
    return print_json({{"scene", options.file},
                       {"contact", options.contact},
                       {"depth_m", depth},
                       {"force_N", force},
                       {"nodes", fields.points.size()},
                       {"elements", fields.tets.size()},
                       {"largest_von_mises_Pa", most},
                       {"written", {options.solved}}});
  }
  char line[200];
  std::snprintf(line, sizeof line, ": %zu nodes, %zu elements, %.3g N at %.3g mm, von Mises stress up to %.4g Pa\n",
                fields.points.size(), fields.tets.size(), force, 1e3 * depth, most);
  print(options.solved + line);
}

void run_export(const ExportArguments& options, const Globals& globals) {
  if (!options.solved.empty()) {
    if (!options.curves.empty() || !options.glb.empty() || !options.vtu.empty() || !options.png.empty()) {
      throw Error(ExitCode::usage, "--solved takes a scene, the others a response file: give one kind");
    }
    return run_solved(options, globals);
  }
  if (options.curves.empty() && options.glb.empty() && options.vtu.empty() && options.png.empty()) {
    throw Error(ExitCode::usage,
                "nothing to write: export takes --curves, --glb, --vtu or --png, or --solved with a scene");
  }
  if (const auto wrong = options.picture.validate()) throw Error(ExitCode::usage, "--png: " + *wrong);
  refuse_same({options.curves, options.glb, options.vtu, options.png}, {options.file});
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
  if (!options.glb.empty() || !options.vtu.empty() || !options.png.empty()) {
    const layout::ToolRecord& record = view.tools[tool];
    if (options.tool_vertex >= record.vertex_count) {
      throw Error(ExitCode::bad_input, options.file + ": the tool '" + record.name + "' has " +
                                           counted(record.vertex_count, "vertex", "vertices") +
                                           ", there is no number " + std::to_string(options.tool_vertex));
    }
    const SurfaceFields surface = body_fields(view, {tool, options.tool_vertex, depth});
    if (std::none_of(surface.fields.begin(), surface.fields.end(),
                     [&](const SurfaceField& f) { return f.name == options.field; })) {
      refuse_field(view, options.file, options.field);
    }
    if (!options.glb.empty()) write_glb(surface, options.field, options.glb);
    if (!options.vtu.empty()) write_vtu(surface, options.field, options.vtu);
    if (!options.png.empty()) write_file(options.png, png_bytes(draw_surface(surface, options.field, options.picture)));
    result["tool"] = record.name;
    result["tool_vertex"] = options.tool_vertex;
    result["vertices"] = surface.points.size();
    result["triangles"] = surface.triangles.size();
    result["shown"] = options.field;
    for (const SurfaceField& f : surface.fields) {
      const auto [low, high] = f.range();
      result["fields"][f.name] = {{"unit", f.unit}, {"least", low}, {"most", high}};
    }
    for (const std::string& path : {options.glb, options.vtu, options.png}) {
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
  Command command(
      app, "export",
      "Writes a response file's curves as CSV, its body with a field as GLB, .vtu or PNG, a solved contact");
  command.option("file", options->file, "Response file (.palp), or with --solved a scene").required();
  command.option("--curves", options->curves, "CSV: force and friction limit of every response along pushes");
  command.option("--glb", options->glb, "GLB: the body, coloured, with the fields as vertex attributes");
  command.option("--vtu", options->vtu, "VTK unstructured grid: the body with the fields as point data");
  command.option("--png", options->png, "PNG: a picture of the body, coloured, drawn without a display");
  PictureOptions& picture = options->picture;
  command.option("--width", picture.width, "Pixels of the picture")
      .check(whole_in(64, 8192))
      .needs("--png")
      .shows_default();
  command.option("--height", picture.height, "Pixels of the picture")
      .check(whole_in(64, 8192))
      .needs("--png")
      .shows_default();
  command.option("--azimuth", picture.azimuth, "Angle of the camera about +z from +x (degrees)")
      .check(number_in(-360, 360))
      .needs("--png")
      .shows_default();
  command.option("--elevation", picture.elevation, "Angle of the camera above the xy plane (degrees)")
      .check(number_in(-90, 90))
      .needs("--png")
      .shows_default();
  command.option(
      "--solved", options->solved,
      "VTK unstructured grid: the volume mesh of one solved contact of a scene, with displacement and stress");
  command.option("--contact", options->contact, "With --solved: number of the contact in the scene's plan")
      .check(whole_in(0, 1000000000))
      .needs("--solved")
      .shows_default();
  command
      .option("--field", options->field,
              "Quantity of the colours: stiffness (N/m), force (N), friction (N, mu times the normal force), filled "
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
