// SPDX-License-Identifier: GPL-3.0-or-later
// palpate mesh: prepares a scene's organ and shows what came of it, before anything is solved.
#include "formats/io/file.hpp"
#include "formats/io/same_file.hpp"
#include "formats/surface/surface_io.hpp"
#include "precompute/common/body.hpp"
#include "precompute/pipeline/scene_warnings.hpp"
#include "precompute/solve/contact/prestress.hpp"
#include "precompute/surface/repair/report.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"

#include <memory>
#include <nlohmann/json.hpp>

namespace palpate::cli {

namespace {

struct MeshArguments {
  std::string scene, out;
};

constexpr const char* kBodyPly = "body.ply";
constexpr const char* kBasePly = "base.ply";
constexpr const char* kPrestressed = "prestressed.ply";

std::string region_file(const std::string& name) { return "region-" + name + ".ply"; }

/// The folder may hold the scene's own surfaces, and these may have the names of what is written.
void check_outputs(const MeshArguments& arguments, const Scene& scene) {
  const std::filesystem::path folder = arguments.out;
  std::vector<std::filesystem::path> inputs = files_of(scene), outputs{folder / kBodyPly, folder / kBasePly};
  inputs.emplace_back(arguments.scene);
  if (scene.prestress.any()) outputs.push_back(folder / kPrestressed);
  for (const RegionScene& region : scene.regions) outputs.push_back(folder / region_file(region.name));
  refuse_same(outputs, inputs);
}

nlohmann::ordered_json to_json(const SurfaceReport& report) {
  return {{"action", report.action},
          {"findings", report.findings},
          {"vertices", report.vertices},
          {"triangles", report.triangles},
          {"largest_move", report.largest_move},
          {"mean_move", report.mean_move},
          {"extents", {report.extents.x(), report.extents.y(), report.extents.z()}},
          {"volume", report.volume},
          {"area", report.area},
          {"thickness_min", report.thickness_min},
          {"thickness_p05", report.thickness_p05},
          {"thickness_median", report.thickness_median},
          {"thin_bag", report.thin_bag}};
}

void run_mesh(const MeshArguments& arguments, const Globals& globals) {
  const Scene scene = read_scene(arguments.scene);
  if (!arguments.out.empty()) check_outputs(arguments, scene);
  const Body loaded = solve::apply_prestress(prepare_body(scene));
  const Body& body = loaded.stress_free ? *loaded.stress_free : loaded;
  for (const std::string& warning : pipeline::scene_warnings(scene, loaded)) warn(warning);
  std::vector<std::filesystem::path> files;
  if (!arguments.out.empty()) {
    const std::filesystem::path folder = arguments.out;
    make_folder(folder);
    write_surface(body.query->surface(), files.emplace_back(folder / kBodyPly));
    write_surface(body.base, files.emplace_back(folder / kBasePly));
    if (loaded.stress_free) write_surface(loaded.query->surface(), files.emplace_back(folder / kPrestressed));
    for (const Inclusion& inclusion : body.inclusions) {
      write_surface(inclusion.query->surface(), files.emplace_back(folder / region_file(inclusion.name)));
    }
  }
  if (globals.json) {
    nlohmann::ordered_json document{{"scene", arguments.scene}, {"surface", to_json(loaded.report)}};
    document["inclusions"] = body.inclusions.size();
    for (const Inclusion& inclusion : body.inclusions) document["regions"][inclusion.name] = to_json(inclusion.report);
    document["base_size"] = body.base_size;
    document["files"] = nlohmann::ordered_json::array();
    for (const auto& file : files) document["files"].push_back(file.string());
    print_json(document);
    return;
  }
  std::string result = surface::text(loaded);
  for (const auto& file : files) result += file.string() + "\n";
  print(result);
  if (body.report.thin_bag) {
    warn("the organ looks like a thin bag, not a solid: name its inner meshes too, or set [body] repair = \"wrap\"");
  }
}

}  // namespace

void add_mesh(CLI::App& app, Globals& globals) {
  auto arguments = std::make_shared<MeshArguments>();
  Command command(app, "mesh", "Prepares the organ's surface and reports what was done to it");
  command.option("scene", arguments->scene, "Scene file").required();
  command.option("--out", arguments->out, "Folder for the prepared surfaces (.ply)");
  command.runs([arguments, &globals] { run_mesh(*arguments, globals); });
}

}  // namespace palpate::cli
