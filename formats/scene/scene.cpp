// SPDX-License-Identifier: MIT
// Reads a scene file: TOML, then every section by its table of keys, then what is wrong only together.
#include "formats/scene/scene.hpp"

#include "formats/io/file.hpp"
#include "formats/scene/scene_keys.hpp"

#include <algorithm>
#include <array>

namespace palpate {

namespace {

using namespace scene_io;

/// Mistake in a line that is no TOML; empty where it is none of the usual mistakes.
std::string toml_hint(const std::string& text, std::size_t line) {
  std::size_t at = 0;
  for (std::size_t k = 1; k < line && at != std::string::npos; ++k) at = text.find('\n', at) + 1;
  if (at >= text.size()) return {};
  const std::string row = text.substr(at, text.find('\n', at) - at);
  const auto equals = row.find('=');
  if (equals == std::string::npos) return {};
  const auto begin = row.find_first_not_of(" \t", equals + 1);
  if (begin == std::string::npos) return "; the value is missing";
  std::string value = row.substr(begin, row.find_first_of("#\r", begin) - begin);
  while (!value.empty() && (value.back() == ' ' || value.back() == '\t')) value.pop_back();
  const auto begins_text = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '/' || c == '~' || c == '.';
  };
  if (value.empty() || !begins_text(value.front()) || value == "true" || value == "false") return {};
  return "; a text needs quotation marks: " + row.substr(0, equals) + "= " + show(value);
}

toml::table parse(const std::filesystem::path& file) {
  std::error_code error;
  if (file.extension() == ".palp" && std::filesystem::is_regular_file(file, error)) {
    throw Error(ExitCode::bad_input, file.string() + ": is a response file; give its scene (TOML)");
  }
  // Scenes are a few kilobytes; the bound keeps a wrong file (an organ, a device) from filling the memory.
  const std::string text = read_file(file, "scene", std::size_t{1} << 20);
  try {
    return toml::parse(text, file.string());
  } catch (const toml::parse_error& wrong) {
    throw Error(ExitCode::bad_input, file.string() + ":" + std::to_string(wrong.source().begin.line) + ": not TOML: " +
                                         std::string(wrong.description()) + toml_hint(text, wrong.source().begin.line));
  }
}

/// The section as a table; null when it is not there.
const toml::table* section(const toml::table& root, const char* name, const Place& place) {
  const toml::node* node = root.get(name);
  return node == nullptr ? nullptr : &to_table(place.below(name), *node);
}

/// A section that may stand several times ([[name]]) or once ([name]).
std::vector<const toml::table*> sections(const toml::table& root, const char* name, const Place& place) {
  const toml::node* node = root.get(name);
  if (node == nullptr) return {};
  if (const auto* table = node->as_table()) return {table};
  const auto* array = node->as_array();
  const std::string allowed = "tables: [[" + std::string(name) + "]]";
  if (array == nullptr || array->empty()) fail_value(place.below(name), *node, allowed);
  std::vector<const toml::table*> tables;
  for (const toml::node& element : *array) {
    if (!element.is_table()) fail_value(place.below(name), element, allowed);
    tables.push_back(element.as_table());
  }
  return tables;
}

template <class T>
void read_section(T& target, const toml::table& root, const char* name, const Keys<T>& keys, const Place& place) {
  if (const toml::table* table = section(root, name, place)) read_table(target, *table, keys, place.below(name));
}

/// `name`, `name2`, ... for those without a name; two with one name are an error.
template <class T>
void name_all(std::vector<T>& items, const std::vector<const toml::table*>& tables, const char* name,
              const Place& place) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!tables[i]->contains("name")) items[i].name = i == 0 ? name : name + std::to_string(i + 1);
    for (std::size_t j = 0; j < i; ++j) {
      if (items[j].name == items[i].name) {
        fail(place.below(name).below("name"), tables[i], "got " + show(items[i].name) + " twice; names must differ");
      }
    }
  }
}

void read_regions(Scene& scene, const toml::table& root, const Place& place) {
  const auto tables = sections(root, "region", place);
  for (const toml::table* table : tables) {
    RegionScene& region = scene.regions.emplace_back();
    read_table(region, *table, region_keys(), place.below("region"));
    check_material(region.material, *table, place.below("region"));
    std::size_t shapes = 0;
    for (const char* name : {"surface", "sphere", "ellipsoid", "box", "labels"})
      shapes += table->contains(name) ? 1 : 0;
    if (shapes != 1) {
      fail(place.below("region"), table,
           "got " + std::to_string(shapes) + " shapes; allowed exactly one of surface, sphere, ellipsoid, box, labels");
    }
  }
  name_all(scene.regions, tables, "region", place);
}

void read_cavities(Scene& scene, const toml::table& root, const Place& place) {
  const auto tables = sections(root, "cavity", place);
  for (const toml::table* table : tables) {
    read_table(scene.cavities.emplace_back(), *table, cavity_keys(), place.below("cavity"));
    if (table->contains("surface") == table->contains("labels")) {
      fail(place.below("cavity"), table, "allowed exactly one of surface, labels");
    }
  }
  name_all(scene.cavities, tables, "cavity", place);
}

void read_supports(Scene& scene, const toml::table& root, const Place& place) {
  for (const toml::table* table : sections(root, "support", place)) {
    const Place here = place.below("support");
    SupportScene& support = scene.supports.emplace_back();
    // Before the count: an unknown key is the likelier mistake and has the better message.
    read_table(support, *table, support_keys(), here);
    std::size_t where = 0;
    for (const char* name : {"mesh", "box", "half_space", "distance"}) where += table->contains(name) ? 1 : 0;
    if (where != 1) {
      fail(here, table,
           "got " + std::to_string(where) + " places; allowed exactly one of mesh, box, half_space, distance");
    }
    const bool spring = support.type == SupportScene::Type::spring;
    if (spring && !table->contains("stiffness")) fail(here.below("stiffness"), table, "missing; a spring bed needs it");
    if (!spring && table->contains("stiffness")) {
      fail(here.below("stiffness"), table->get("stiffness"), "only a support of type \"spring\" has it");
    }
  }
}

/// Keys of a tool that its shape has no use for are errors: they would look as if they did something.
void check_tool(const ToolScene& tool, const toml::table& table, const Place& place) {
  static const std::array<std::vector<std::string>, 6> used{
      {{"radius"},
       {"radius", "edge_radius", "length"},
       {"radius", "length", "contacts", "spins"},
       {"surface", "meshes", "units", "spacing", "edge_radius", "spins"},
       {"radius", "half_angle", "length"},
       {"radius", "half_angle", "shaft_radius", "length"}}};
  static const std::array<const char*, 6> names{"sphere", "punch", "capsule", "mesh", "cone", "needle"};
  const auto shape = static_cast<std::size_t>(tool.shape);
  for (const auto& [key, value] : table) {
    if (key == "name" || key == "shape" || key == "grasp_depth" || key == "grasp_turn") continue;
    if (std::find(used[shape].begin(), used[shape].end(), key.str()) == used[shape].end()) {
      fail(place.below(key.str()), &value,
           std::string("a tool of shape ") + show(std::string(names[shape])) +
               " has no such key; it has: " + show(used[shape]));
    }
  }
  if (tool.grasp_turn > 0 && !(tool.grasp_depth > 0)) {
    fail(place.below("grasp_turn"), table.get("grasp_turn"), "only a tool that holds on turns: it needs grasp_depth");
  }
  if (tool.grasp_turn > 0 && tool.grasp_turn < 0.01) {  // torques of less are lost in the solver's tolerance
    fail(place.below("grasp_turn"), table.get("grasp_turn"),
         "got " + show(tool.grasp_turn) + "; allowed 0, or 0.01 to 0.5 rad");
  }
  if (tool.spins > 1 && tool.shape == ToolScene::Shape::capsule && !tool.whole) {
    fail(place.below("spins"), table.get("spins"), "the tip alone (contacts = \"tip\") is round: it has one spin");
  }
  if (tool.shape == ToolScene::Shape::mesh && !table.contains("surface")) {
    fail(place.below("surface"), &table, "missing; a tool of shape \"mesh\" needs a closed surface");
  }
  if (tool.shape == ToolScene::Shape::needle && tool.shaft_radius > 0 && tool.shaft_radius <= tool.radius) {
    fail(place.below("shaft_radius"), table.get("shaft_radius"),
         "got " + show(tool.shaft_radius) + "; allowed x > radius = " + show(tool.radius) + " m");
  }
  if (tool.shape != ToolScene::Shape::punch) return;
  if (tool.edge_radius >= tool.radius) {
    fail(place.below("edge_radius"), table.get("edge_radius"),
         "got " + show(tool.edge_radius) + "; allowed x < radius = " + show(tool.radius) + " m");
  }
  const double rim = tool.edge_radius > 0 ? tool.edge_radius : tool.radius / 10;
  if (tool.length < rim) {
    fail(place.below("length"), table.contains("length") ? table.get("length") : &table,
         "got " + show(tool.length) + "; allowed x >= edge_radius = " + show(rim) + " m");
  }
}

void read_tools(Scene& scene, const toml::table& root, const Place& place) {
  const auto tables = sections(root, "tool", place);
  for (const toml::table* table : tables) {
    read_table(scene.tools.emplace_back(), *table, tool_keys(), place.below("tool"));
    check_tool(scene.tools.back(), *table, place.below("tool"));
  }
  name_all(scene.tools, tables, "tool", place);
  if (scene.tools.empty()) scene.tools.emplace_back();
}

void check_capsule(const BodyScene& body, const toml::table& root, const Place& place) {
  const auto missing = [&](const char* key, const char* why) {
    fail(place.below("body").below(key), root["body"].node(), std::string("missing; ") + why);
  };
  if (body.capsule_thickness > 0 && !(body.capsule_young > 0)) missing("capsule_young", "a capsule needs a modulus");
  if (body.capsule_young > 0 && !(body.capsule_thickness > 0)) missing("capsule_thickness", "a capsule needs one");
}

void check_sampling(const SamplingScene& sampling, const toml::table& root, const Place& place) {
  if (sampling.margin_spacing > sampling.spacing) {
    fail(place.below("sampling.margin_spacing"), root["sampling"]["margin_spacing"].node(),
         "got " + show(sampling.margin_spacing) + "; allowed x <= spacing = " + show(sampling.spacing) + " m" +
             (sampling.spacing > 0 ? "" : " (0: automatic)"));
  }
  // Each is one of the normal indentation's own depths.
  if (sampling.tangential_depths > sampling.normal_points) {
    fail(place.below("sampling.tangential_depths"), root["sampling"]["tangential_depths"].node(),
         "got " + show(sampling.tangential_depths) +
             "; allowed 2 <= x <= normal_points = " + show(sampling.normal_points));
  }
}

/// Names the replacement of a key that earlier versions had.
void check_removed(const toml::table& root, const Place& place) {
  const toml::table* table = section(root, "response", place);
  if (table == nullptr) return;
  constexpr std::pair<const char*, const char*> kRemoved[] = {
      {"model",
       "every response is a quadratic potential, with friction or without; `palpate bench --models` compares "
       "it with the separable field, the linear spring and a radial-basis network"},
      {"order", "the potential is quadratic (order 2)"},
      {"slip", "every contact with friction slips in part before it slips as a whole"}};
  for (const auto& [name, instead] : kRemoved) {
    if (const toml::node* node = table->get(name)) {
      fail(place.below(std::string("response.") + name), node,
           std::string("was removed: ") + instead + "; delete the key");
    }
  }
}

/// A key of a section that was written outside of it gets a message of its own.
void check_outside(const toml::table& root, const Place& place) {
  const auto look = [&](const char* name, const auto& keys) {
    for (const auto& key : keys) {
      const toml::node* node = root.get(key.name);
      if (node == nullptr || key.name == "name") continue;
      const auto& sections_known = section_names();
      if (std::find(sections_known.begin(), sections_known.end(), key.name) != sections_known.end()) continue;
      fail(place.below(key.name), node, "unknown key here; it belongs into the section [" + std::string(name) + "]");
    }
  };
  look("body", body_keys());
  look("material", material_keys());
  look("contact", contact_keys());
  look("sampling", sampling_keys());
  look("prestress", prestress_keys());
  look("tool", tool_keys());
  look("response", response_keys());
  look("solver", solver_keys());
  look("compliance", compliance_keys());
}

SceneSources to_sources(const toml::table& root, const Place& place) {
  SceneSources sources;
  read_section(sources, root, "sources", sources_keys(), place);
  for (const toml::table* table : sections(root, "measured", place)) {
    read_table(sources.measured.emplace_back(), *table, measured_keys(), place.below("measured"));
    check_measured(*table, place.below("measured"));
  }
  for (const toml::table* table : sections(root, "analytic", place)) {
    read_table(sources.analytic.emplace_back(), *table, analytic_keys(), place.below("analytic"));
    check_analytic(sources.analytic.back(), *table, place.below("analytic"));
  }
  return sources;
}

}  // namespace

SceneSources read_sources(const std::filesystem::path& scene_file) {
  return to_sources(parse(scene_file), {scene_file, ""});
}

Scene read_scene(const std::filesystem::path& file) {
  const toml::table root = parse(file);
  const Place place{file, ""};
  Scene scene;
  scene.file = file;
  check_outside(root, place);
  read_table(scene, root, scene_keys(), place, section_names());
  if (scene.name.empty()) scene.name = file.stem().string();

  read_section(scene.body, root, "body", body_keys(), place);
  check_capsule(scene.body, root, place);
  read_section(scene.material, root, "material", material_keys(), place);
  if (const toml::table* table = section(root, "material", place)) {
    check_material(scene.material, *table, place.below("material"));
  }
  read_regions(scene, root, place);
  read_cavities(scene, root, place);
  read_supports(scene, root, place);
  read_section(scene.prestress, root, "prestress", prestress_keys(), place);
  if (const toml::table* table = section(root, "prestress", place)) {
    check_prestress(scene.prestress, *table, place.below("prestress"));
  }
  read_tools(scene, root, place);
  read_section(scene, root, "contact", contact_keys(), place);
  for (const ToolScene& tool : scene.tools) {  // without a depth in the scene
    const bool round = tool.shape == ToolScene::Shape::sphere || tool.shape == ToolScene::Shape::capsule;
    if (round) scene.sampling.depth = std::min(scene.sampling.depth, tool.radius);
  }
  read_section(scene.sampling, root, "sampling", sampling_keys(), place);
  check_removed(root, place);
  read_section(scene.response, root, "response", response_keys(), place);
  read_section(scene.solver, root, "solver", solver_keys(), place);
  if (const toml::table* table = section(root, "compliance", place)) {
    scene.compliance.between = ComplianceScene::Between::contacts;
    read_table(scene.compliance, *table, compliance_keys(), place.below("compliance"));
  }
  static_cast<void>(to_sources(root, place));  // kept apart; what is wrong there is wrong in the scene

  if (scene.body.surfaces.empty() && scene.body.labels.file.empty()) {
    fail(place.below("body.surface"), root.get("body"),
         "missing; a scene needs a surface file, for example:  [body] surface = \"liver.ply\"  or voxels:  [body] "
         "labels = {image = \"liver.nii.gz\", value = 1}");
  }
  if (!scene.body.surfaces.empty() && !scene.body.labels.file.empty()) {
    fail(place.below("body.labels"), root["body"]["labels"].node(), "allowed exactly one of surface, labels");
  }
  check_sampling(scene.sampling, root, place);
  for (const ToolScene& tool : scene.tools) {
    if (tool.grasp_depth <= scene.sampling.depth) continue;
    fail(place.below("tool.grasp_depth"), root.get("tool"),
         "got " + show(tool.grasp_depth) + "; allowed x <= sampling.depth = " + show(scene.sampling.depth) + " m");
  }
  return scene;
}

std::vector<std::filesystem::path> files_of(const Scene& scene) {
  std::vector<std::filesystem::path> files;
  const auto add = [&](const SurfaceSource& source) {
    if (!source.file.empty()) files.push_back(source.file);
  };
  for (const SurfaceSource& source : scene.body.surfaces) add(source);
  const auto add_image = [&](const LabelSource& labels) {
    if (!labels.file.empty()) files.push_back(labels.file);
  };
  add_image(scene.body.labels);
  add(scene.material.centreline);
  for (const RegionScene& region : scene.regions) {
    add(region.surface);
    add_image(region.labels);
    add(region.material.centreline);
  }
  for (const CavityScene& cavity : scene.cavities) {
    add(cavity.surface);
    add_image(cavity.labels);
  }
  for (const SupportScene& support : scene.supports) add(support.other);
  for (const ToolScene& tool : scene.tools) add(tool.surface);
  return files;
}

}  // namespace palpate
