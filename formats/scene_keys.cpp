// SPDX-License-Identifier: MIT
// All keys of a scene with ranges and help. Reading, messages, the reference and the canonical text come from here.
#include "formats/scene_keys.hpp"

#include "formats/scene_key_kinds.hpp"
#include "palpate/response_layout.hpp"

#include <algorithm>

namespace palpate::scene_io {

namespace {

constexpr Range kLength{0, 10, true, "m"};
constexpr Range kLengthOrAuto{0, 10, false, "m"};
constexpr Range kBed{0, 1e15, true, "N/m^3"};
constexpr std::size_t kLongestToolName = sizeof(layout::ToolRecord::name) - 1;

/// Regions are written to files of their names.
bool names_a_file(const std::string& name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
           c == '.' || c == ' ';
  };
  return name.front() != '.' && std::all_of(name.begin(), name.end(), plain);
}

Key<SupportScene> support_kind(const char* name, SupportScene::Kind kind, const char* help, const char* allowed,
                               const char* example,
                               std::function<void(SupportScene&, const toml::node&, const Place&)> read,
                               std::function<std::string(const SupportScene&)> show_value) {
  return {name,
          Affects::solves,
          help,
          allowed,
          [=](SupportScene& target, const toml::node& value, const toml::table&, const Place& place) {
            target.kind = kind;
            read(target, value, place);
          },
          [=](const SupportScene& target) { return target.kind == kind ? show_value(target) : ""; },
          example};
}

void read_half_space(SupportScene& target, const toml::node& value, const Place& place) {
  const auto vector = [](const char* name, Eigen::Vector3d SupportScene::*member) {
    return Key<SupportScene>{name,
                             Affects::solves,
                             "",
                             "",
                             [=](SupportScene& support, const toml::node& node, const toml::table&, const Place& at) {
                               support.*member = to_vector(at, node, kCoordinate);
                             },
                             {},
                             ""};
  };
  const toml::table& table = to_table(place, value);
  read_table(target, table, {vector("point", &SupportScene::point), vector("normal", &SupportScene::normal)}, place);
  if (!table.contains("point") || !table.contains("normal")) {
    fail(place, &value, "a half-space needs both 'point' and 'normal'");
  }
  const double length = target.normal.norm();
  if (!(length > 1e-9)) fail_value(place.below("normal"), *table.get("normal"), "a vector of length > 1e-9");
  target.normal /= length;
}

// A table of these two keys and no others.
const toml::table& two_of(const toml::node& value, const Place& place, const char* first, const char* second) {
  const toml::table& table = to_table(place, value);
  if (table.size() != 2 || !table.contains(first) || !table.contains(second)) {
    fail(place, &value, std::string("needs '") + first + "' and '" + second + "', and nothing else");
  }
  return table;
}

void read_distance(SupportScene& target, const toml::node& value, const Place& place) {
  const toml::table& table = to_table(place, value);
  Keys<SupportScene> keys = surface_keys(&SupportScene::other, "");
  keys.push_back(number("within", &SupportScene::within, kLength, ""));
  read_table(target, table, keys, place);
  if (!table.contains("surface") || !table.contains("within")) {
    fail(place, &value, "a distance support needs both 'surface' and 'within'");
  }
}

std::string show_distance(const SupportScene& support) {
  std::string text = "{surface = " + show(support.other.file.string());
  if (!support.other.meshes.empty()) text += ", meshes = " + show(support.other.meshes);
  return text + ", units = " + show_unit(support.other.unit) + ", within = " + show(support.within) + "}";
}

// Of the table of a region's labels.
Keys<RegionScene> label_keys() {
  return {{"image",
           Affects::nothing,
           "",
           "",
           [](RegionScene& region, const toml::node& value, const toml::table& parent, const Place& place) {
             region.surface = source_beside(to_text(place, value), parent, above(place));
           },
           {},
           ""},
          integer("value", &RegionScene::label, {-2147483648.0, 2147483647.0, false, ""}, ""),
          {"units",
           Affects::solves,
           "",
           "",  // taken up with the image
           [](RegionScene&, const toml::node&, const toml::table&, const Place&) {},
           {},
           ""}};
}

}  // namespace

const std::vector<std::string>& section_names() {
  static const std::vector<std::string> names{"body",    "material", "region",   "support",  "prestress",
                                              "tool",    "contact",  "sampling", "response", "solver",
                                              "sources", "measured", "analytic"};
  return names;
}

const Keys<Scene>& scene_keys() {
  static const Keys<Scene> keys{
      {"name", Affects::nothing, "Name of the scene and of the files made from it; left out: the scene file's name.",
       "a text without '/'",
       [](Scene& scene, const toml::node& value, const toml::table&, const Place& place) {
         scene.name = to_text(place, value);
         if (scene.name.find('/') != std::string::npos || scene.name.front() == '.') {
           fail_value(place, value, "a name without '/' that does not begin with '.'");
         }
       },
       [](const Scene& scene) { return scene.name.empty() ? "" : show(scene.name); }, "\"liver\""}};
  return keys;
}

const Keys<BodyScene>& body_keys() {
  static const Keys<BodyScene> keys = join<BodyScene>(
      join<BodyScene>(
          {{"surface", Affects::nothing,
            "Required. Surface file (.glb .gltf .obj .stl .ply .off), or an array of files or of tables "
            "{file, meshes, units}, joined into one body.",
            "file names, relative to the scene file",
            [](BodyScene& body, const toml::node& value, const toml::table& parent, const Place& place) {
              body.surfaces = to_sources(place, value, parent);
            },
            [](const BodyScene& body) { return body.surfaces.empty() ? "" : show(body.surfaces[0].file.string()); },
            "\"FILE\""}},
          source_keys<BodyScene>(
              [](const BodyScene& body) { return body.surfaces.size() == 1 ? &body.surfaces[0] : nullptr; })),
      {choice("repair", &BodyScene::repair, {"auto", "none", "repair", "wrap"},
              "What is done to a surface that is not closed, manifold and free of self-intersections; "
              "auto: the least that works."),
       number(
           "wrap_alpha", &BodyScene::wrap_alpha, kLengthOrAuto,
           "Smallest opening that a wrap enters; 0: the smallest tool's radius, but at least 1/50 and at most 1/20 of "
           "the bounding box's diagonal."),
       number("wrap_offset", &BodyScene::wrap_offset, kLengthOrAuto,
              "Distance of a wrap to the surface; 0: wrap_alpha / 30."),
       integer("smooth", &BodyScene::smooth, {0, 3, false, ""},
               "Rounds of subdivision through the clean surface's vertices, for files whose facets a small tip would "
               "feel; sharp edges become round."),
       number("capsule_thickness", &BodyScene::capsule_thickness, kLengthOrAuto,
              "Of a thin sheet on the outside (not in cavities) that stretches and does not bend (an organ's capsule); "
              "0: none."),
       number("capsule_young", &BodyScene::capsule_young, {0, 1e12, false, "Pa"},
              "Of that sheet, incompressible neo-Hookean.")});
  return keys;
}

const Keys<RegionScene>& region_keys() {
  static const Keys<RegionScene> keys = [] {
    Keys<RegionScene> all{text("name", &RegionScene::name, "Name; left out: region, region2, ...", "\"tumour\"",
                               "letters, digits, spaces and - _ . in any order, but no '.' at the beginning",
                               names_a_file)};
    all = join(all, surface_keys(&RegionScene::surface, "Closed surface strictly inside the body."));
    all.push_back({"sphere", Affects::solves, "In place of a surface: a ball.",
                   "{center = [x, y, z], radius = r}, 0 < r <= 10 m",
                   [](RegionScene& region, const toml::node& value, const toml::table&, const Place& place) {
                     const toml::table& table = two_of(value, place, "center", "radius");
                     region.shape = RegionScene::Shape::ellipsoid;
                     region.centre = to_vector(place.below("center"), *table.get("center"), kCoordinate);
                     region.radii.setConstant(to_number(place.below("radius"), *table.get("radius"), kLength));
                   },
                   [](const RegionScene&) { return std::string(); }, "{center = [0, 0, 0.1], radius = 0.01}"});
    all.push_back({"ellipsoid", Affects::solves, "In place of a surface: an ellipsoid along the axes.",
                   "{center = [x, y, z], radii = [a, b, c]}, 0 < a, b, c <= 10 m",
                   [](RegionScene& region, const toml::node& value, const toml::table&, const Place& place) {
                     const toml::table& table = two_of(value, place, "center", "radii");
                     region.shape = RegionScene::Shape::ellipsoid;
                     region.centre = to_vector(place.below("center"), *table.get("center"), kCoordinate);
                     region.radii = to_vector(place.below("radii"), *table.get("radii"), kLength);
                   },
                   [](const RegionScene& r) {
                     return r.shape == RegionScene::Shape::ellipsoid
                                ? "{center = " + show(r.centre) + ", radii = " + show(r.radii) + "}"
                                : std::string();
                   },
                   "{center = [0, 0, 0.1], radii = [0.01, 0.02, 0.01]}"});
    all.push_back({"box", Affects::solves, "In place of a surface: a box along the axes.",
                   "{min = [x, y, z], max = [x, y, z]}, min < max, m",
                   [](RegionScene& region, const toml::node& value, const toml::table&, const Place& place) {
                     region.shape = RegionScene::Shape::box;
                     std::tie(region.box_min, region.box_max) = to_box(place, value);
                   },
                   [](const RegionScene& r) {
                     return r.shape == RegionScene::Shape::box ? show_box(r.box_min, r.box_max) : std::string();
                   },
                   "{min = [0, 0, 0.1], max = [0.02, 0.02, 0.12]}"});
    all.push_back({"labels", Affects::solves,
                   "In place of a surface: the voxels of one value in a label image (NRRD, MetaImage), in the "
                   "coordinates of that file, which have to be the surface's (no turn from LPS to RAS).",
                   "{image = \"FILE\", value = n, units}, -2147483648 <= n <= 2147483647",
                   [](RegionScene& region, const toml::node& value, const toml::table&, const Place& place) {
                     const toml::table& table = to_table(place, value);
                     region.shape = RegionScene::Shape::labels;
                     read_table(region, table, label_keys(), place);
                     if (!table.contains("image") || !table.contains("value"))
                       fail(place, &value, "labels need both 'image' and 'value'");
                   },
                   [](const RegionScene& r) {
                     return r.shape == RegionScene::Shape::labels
                                ? "{image = " + show(r.surface.file.string()) + ", value = " + show(r.label) +
                                      ", units = " + show_unit(r.surface.unit) + "}"
                                : std::string();
                   },
                   "{image = \"FILE\", value = 1, units = \"mm\"}"});
    for (const Key<MaterialScene>& key : material_keys()) {
      all.push_back({key.name, key.affects, key.help, key.allowed,
                     [=](RegionScene& region, const toml::node& value, const toml::table& parent, const Place& place) {
                       key.read(region.material, value, parent, place);
                     },
                     [=](const RegionScene& region) { return key.show(region.material); }, key.example});
    }
    return all;
  }();
  return keys;
}

const Keys<SupportScene>& support_keys() {
  using Kind = SupportScene::Kind;
  static const Keys<SupportScene> keys{
      support_kind(
          "mesh", Kind::mesh, "Held: the part of the body's surface that came from this mesh.", "a text", "\"NAME\"",
          [](SupportScene& s, const toml::node& value, const Place& place) { s.mesh = to_text(place, value); },
          [](const SupportScene& s) { return show(s.mesh); }),
      support_kind(
          "box", Kind::box, "Held: the surface inside this box.", "{min = [x, y, z], max = [x, y, z]}, min < max, m",
          "{min = [-1, -1, -1], max = [1, 1, 0]}",
          [](SupportScene& s, const toml::node& value, const Place& place) {
            std::tie(s.box_min, s.box_max) = to_box(place, value);
          },
          [](const SupportScene& s) { return show_box(s.box_min, s.box_max); }),
      support_kind(
          "half_space", Kind::half_space, "Held: the surface where (x - point) . normal <= 0.",
          "{point = [x, y, z], normal = [x, y, z]}, m", "{point = [0, 0, 0], normal = [0, 0, 1]}", read_half_space,
          [](const SupportScene& s) { return "{point = " + show(s.point) + ", normal = " + show(s.normal) + "}"; }),
      support_kind("distance", Kind::distance, "Held: the surface within this distance of another surface.",
                   "{surface, meshes, units, within}, 0 < within <= 10 m", "{surface = \"FILE\", within = 0.002}",
                   read_distance, show_distance),
      choice("type", &SupportScene::type, {"fixed", "spring", "slider"},
             "fixed; an elastic bed; or free to slide along the surface and held across it."),
      {"stiffness", Affects::solves, "spring: required, traction over displacement.", kBed.text(),
       [](SupportScene& s, const toml::node& value, const toml::table&, const Place& place) {
         s.stiffness = to_number(place, value, kBed);
       },
       [](const SupportScene& s) { return s.type == SupportScene::Type::spring ? show(s.stiffness) : std::string(); },
       "1e5"}};
  return keys;
}

const Keys<ToolScene>& tool_keys() {
  Key<ToolScene> grasp = number("grasp_depth", &ToolScene::grasp_depth, kLengthOrAuto,
                                "A tool that can hold on: the contact that it makes at this depth, at most "
                                "sampling.depth, is bonded, and then pulled out and aside as well; 0: it cannot.");
  // Solves of tools that cannot stay valid.
  grasp.show = [show = grasp.show](const ToolScene& tool) { return tool.grasp_depth > 0 ? show(tool) : std::string(); };
  grasp.example = "0.002";
  Key<ToolScene> turn = number("grasp_turn", &ToolScene::grasp_turn, {0, 0.5, false, "rad"},
                               "With grasp_depth: angle by which the bonded tool is also turned about the point by "
                               "which it touched (twist and rolling), for torques; 0: turns have none.");
  turn.show = [show = turn.show](const ToolScene& tool) { return tool.grasp_turn > 0 ? show(tool) : std::string(); };
  turn.example = "0.2";
  // The response file has a field of fixed length for it: too long a name must not be found after the bake.
  static const Keys<ToolScene> keys = join<ToolScene>(
      join<ToolScene>(
          {text("name", &ToolScene::name, "Name; left out: tool, tool2, ...", "\"probe\"",
                "a text of at most " + std::to_string(kLongestToolName) + " bytes",
                [](const std::string& name) { return name.size() <= kLongestToolName; }),
           choice("shape", &ToolScene::shape, {"sphere", "punch", "capsule", "mesh", "cone", "needle"},
                  "sphere tip, flat-ended punch, capsule (tip and stem), closed mesh, cone or needle."),
           number("radius", &ToolScene::radius, {0, 1, true, "m"},
                  "sphere, punch, capsule: radius; cone, needle: of the rounded tip, which is what touches."),
           number("edge_radius", &ToolScene::edge_radius, {0, 1, false, "m"},
                  "punch: rounding of its rim, below the radius; 0: a tenth of the radius. mesh: scale on which facets "
                  "and sharp edges are rounded; 0: a twentieth of its smallest extent."),
           number("length", &ToolScene::length, kLength,
                  "punch, cone, needle: height; capsule: distance between the centres of its caps."),
           number("half_angle", &ToolScene::half_angle, {0.02, 1.5, false, "rad"},
                  "cone, needle: between the axis and the side."),
           number("shaft_radius", &ToolScene::shaft_radius, {0, 1, false, "m"},
                  "needle: radius above its point, more than radius; 0: four times the radius.")},
          surface_keys(&ToolScene::surface, "mesh: required, a closed surface in the tool's frame.")),
      {{"contacts", Affects::solves, "capsule: which of it touches, all of it or its tip only (one tool vertex).",
        show_choices({"all", "tip"}),
        [](ToolScene& tool, const toml::node& value, const toml::table&, const Place& place) {
          tool.whole = to_choice(place, value, {"all", "tip"}) == 0;
        },
        [](const ToolScene& tool) { return show(std::string(tool.whole ? "all" : "tip")); }, ""},
       number("spacing", &ToolScene::spacing, kLengthOrAuto,
              "mesh: edge length of the tool's patches; 0: a third of its size."),
       grasp,
       turn});
  return keys;
}

const Keys<Scene>& contact_keys() {
  static const Keys<Scene> keys{number("friction", &Scene::friction, {0, 2, false, ""},
                                       "Coulomb coefficient; 0: no friction, and nothing sideways is solved.")};
  return keys;
}

const Keys<SamplingScene>& sampling_keys() {
  using S = SamplingScene;
  static const Keys<S> keys{
      number("spacing", &S::spacing, {0, 1, true, "m"}, "Edge length of the body's patches."),
      number("margin_spacing", &S::margin_spacing, {0, 1, false, "m"},
             "Edge length at sharp margins, at most spacing; 0: spacing / 2."),
      number("depth", &S::depth, {0, 1, true, "m"}, "Deepest push."),
      number("depth_fraction", &S::depth_fraction, {0, 0.8, true, ""},
             "Deepest push as a share of the local thickness, where that is less than depth; over a cavity of wall and "
             "cavity together."),
      integer("normal_points", &S::normal_points, {4, 64, false, ""}, "Solved points of a straight push."),
      integer("tangential_depths", &S::tangential_depths, {2, 8, false, ""},
              "Depths at which it is pushed sideways; at most normal_points."),
      integer("tangential_directions", &S::tangential_directions, {4, 16, false, ""}, "Directions sideways.", 2),
      integer("tangential_points", &S::tangential_points, {2, 16, false, ""}, "Solved points of one sideways push."),
      choice("friction_limit", &S::friction_limit, {"estimated", "solved"},
             "With friction, the sideways over the normal force at which a contact slides: foretold from the slopes of "
             "the straight push, or solved by drawing the tool aside until all of the contact slips."),
      affecting(Affects::file, number("max_refused", &S::max_refused, {0, 0.5, false, ""},
                                      "Share of refused pairs beyond which the fit fails.")),
      {"within_box", Affects::solves, "Only the surface inside this box is sampled; left out: all of it.",
       "{min = [x, y, z], max = [x, y, z]}, min < max, m",
       [](S& sampling, const toml::node& value, const toml::table&, const Place& place) {
         sampling.within_box = to_box(place, value);
       },
       [](const S& s) { return s.within_box ? show_box(s.within_box->first, s.within_box->second) : std::string(); },
       "{min = [-1, -1, 0], max = [1, 1, 1]}"}};
  return keys;
}

const Keys<ResponseScene>& response_keys() {
  using R = ResponseScene;
  // Not there for a scene of another model, whose texts (and hashes) know nothing of it.
  const auto only_coupled = [](Key<R> key, const char* example) {
    key.affects = Affects::file;
    key.example = example;
    key.show = [show = key.show](const R& r) { return r.model == R::Model::coupled ? show(r) : std::string(); };
    return key;
  };
  static const Keys<R> keys{
      affecting(
          Affects::file,
          choice("model", &R::model, {"separable", "coupled", "linear"},
                 "separable: the axes' answers add; coupled: sideways and normal answers act on "
                 "each other, and follow a contact that deepens or lifts under side load. It is "
                 "sampled in at least 8 directions at 4 depths, and needs friction. linear: a spring in 16 "
                 "bytes (24 with its head), without the sideways force of a straight push; it needs friction too.")),
      only_coupled(integer("order", &R::order, {0, 4, false, ""},
                           "coupled: of the energy in the sideways deflection, 2 to 4; 0: the least whose error on "
                           "samples held out meets the tolerance."),
                   "0"),
      only_coupled(number("path_share", &R::path_share, {0, 1, false, ""},
                          "coupled: share of the pairs that are also pushed along paths (diagonal, side then deeper, "
                          "lift under side load) which only test."),
                   "0.1"),
      affecting(Affects::file, choice("search", &R::search, {"auto", "none", "bvh"},
                                      "Contact search stored in the file; auto: where the body is large.")),
      affecting(Affects::file, number("tolerance", &R::tolerance, {0, 0.99, true, ""},
                                      "Asked relative force error: palpate verify tells whether the 95th percentile of "
                                      "straight pushes meets it; only its option --max-p95 makes it fail."))};
  return keys;
}

const Keys<SolverScene>& solver_keys() {
  using S = SolverScene;
  static const Keys<S> keys{
      number("mesh_size", &S::mesh_size, {0.05, 1, false, ""},
             "Element edge at the contact, in contact radii at full depth."),
      number("growth", &S::growth, {0, 1, true, ""}, "Growth of the edge length per distance from the contact."),
      number("max_size", &S::max_size, kLengthOrAuto,
             "Longest element edge; 0: 1/8 of the bounding box's diagonal, at most twice the median wall."),
      number("rim_size", &S::rim_size, {0, 1, false, ""},
             "Element edge of a ring of fine elements at the deepest contact's rim, in contact radii: for an accurate "
             "tangential stiffness, at the price of time; 0: no ring."),
      number("time_limit", &S::time_limit, {0, 86400, true, "s"}, "Time for one pair's mesh; beyond it: refused."),
      number(
          "check_share", &S::check_share, {0, 1, false, ""},
          "Share of the pairs, at least one, whose straight push the bake also solves on a finer mesh; one that is far "
          "off is refused, and palpate verify reports the differences. 0: none."),
      integer("check_seed", &S::check_seed, {0, 1000000, false, ""}, "Draws these pairs.")};
  return keys;
}

}  // namespace palpate::scene_io
