// SPDX-License-Identifier: MIT
// All keys of a scene with ranges and help. Reading, messages, the reference and the canonical text come from here.
#include "formats/scene/scene_keys.hpp"

#include "formats/scene/scene_key_kinds.hpp"
#include "palpate/format/response_layout.hpp"

#include <algorithm>

namespace palpate::scene_io {

namespace {

constexpr Range kLengthOrAuto{0, 10, false, "m"};
const std::vector<std::string> kFrames{"LPS", "RAS"};
constexpr std::size_t kLongestToolName = sizeof(layout::ToolRecord::name) - 1;
constexpr double kLeastApart = 1e-6;  // m, of two given sites: nearer ones are one vertex of a mesh

std::vector<Eigen::Vector3d> to_points(const Place& place, const toml::node& value) {
  const auto* list = value.as_array();
  if (list == nullptr || list->empty()) fail_value(place, value, "points [[x, y, z], ...], m");
  std::vector<Eigen::Vector3d> points;
  for (const toml::node& node : *list) {
    points.push_back(to_vector(place, node, {-1000, 1000, false, "m"}));
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      if ((points[k] - points.back()).norm() < kLeastApart) fail_value(place, node, "places at least 1e-6 m apart");
    }
  }
  return points;
}

}  // namespace

const std::vector<std::string>& section_names() {
  static const std::vector<std::string> names{"body",      "material",   "region",  "cavity",   "support",
                                              "prestress", "tool",       "contact", "sampling", "response",
                                              "solver",    "compliance", "sources", "measured", "analytic"};
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
       [](const Scene& scene) { return scene.name.empty() ? "" : show(scene.name); }, "\"liver\""},
      {"frame", Affects::solves,
       "Frame of all coordinates here: LPS (x left, y back; DICOM, ITK) or RAS (x right, y front; NIfTI). Files that "
       "state another are turned into it; left out: the one that the body's file states.",
       show_choices(kFrames),
       [](Scene& scene, const toml::node& value, const toml::table&, const Place& place) {
         scene.frame = to_choice(place, value, kFrames) == 0 ? Frame::lps : Frame::ras;
       },
       [](const Scene& scene) {
         return scene.frame == Frame::unstated ? "" : show(kFrames[scene.frame == Frame::lps ? 0 : 1]);
       },
       "\"LPS\""}};
  return keys;
}

const Keys<BodyScene>& body_keys() {
  static const Keys<BodyScene> keys = join<BodyScene>(
      join<BodyScene>(
          {{"surface", Affects::nothing,
            "Required, or labels. Surface file (.glb .gltf .obj .stl .ply .off .vtp .vtk), or an array of files or of "
            "tables {file, meshes, units}, joined into one body.",
            "file names, relative to the scene file",
            [](BodyScene& body, const toml::node& value, const toml::table& parent, const Place& place) {
              body.surfaces = to_sources(place, value, parent);
            },
            [](const BodyScene& body) { return body.surfaces.empty() ? "" : show(body.surfaces[0].file.string()); },
            "\"FILE\""}},
          source_keys<BodyScene>(
              [](const BodyScene& body) { return body.surfaces.size() == 1 ? &body.surfaces[0] : nullptr; })),
      {{"labels", Affects::solves,
        "In place of a surface: voxels of a label image (NIfTI, NRRD, MetaImage), by value or by the segment's name. "
        "Regions and cavities of the same image belong to the body as well.",
        kLabelsAllowed,
        [](BodyScene& body, const toml::node& value, const toml::table&, const Place& place) {
          body.labels = to_labels(place, value);
        },
        [](const BodyScene& body) {
          return body.labels.values.empty() && body.labels.segments.empty() ? "" : show_labels(body.labels);
        },
        kLabelsExample},
       choice("repair", &BodyScene::repair, {"auto", "none", "repair", "wrap"},
              "Repair of a surface that is not closed, manifold and free of self-intersections; "
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
              "Thickness of a thin sheet on the outside (not in cavities) that stretches and does not bend (an organ's "
              "capsule); "
              "0: none."),
       number("capsule_young", &BodyScene::capsule_young, {0, 1e12, false, "Pa"},
              "Young's modulus of that sheet, incompressible neo-Hookean.")});
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
  Key<ToolScene> spins = integer(
      "spins", &ToolScene::spins, {1, layout::kMaxSpins, false, ""},
      "capsule with all its contacts, mesh: at how many angles about the normal of a contact each of its points "
      "(but a tip, which is round) is sampled; 1: how it is turned does not count.");
  spins.show = [show = spins.show](const ToolScene& tool) { return tool.spins > 1 ? show(tool) : std::string(); };
  spins.example = "8";
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
       spins,
       grasp,
       turn});
  return keys;
}

const Keys<Scene>& contact_keys() {
  static const Keys<Scene> keys{number("friction", &Scene::friction, {0, 2, false, ""},
                                       "Coulomb coefficient; 0: no friction, and no tangential push is solved.")};
  return keys;
}

const Keys<SamplingScene>& sampling_keys() {
  using S = SamplingScene;
  static const Keys<S> keys{
      number(
          "spacing", &S::spacing, {0, 1, false, "m"},
          "Edge length of the body's patches, everywhere the same and solved in full; 0: begins with patches as large "
          "as the body allows and adds sites, most with a normal indentation alone, until the error at hidden "
          "contacts is within response.tolerance."),
      affecting(Affects::file, integer("most_sites", &S::most_sites, {8, 1000000, false, ""},
                                       "Without a spacing: no more sites are added once there are so many.")),
      number("margin_spacing", &S::margin_spacing, {0, 1, false, "m"},
             "Edge length at sharp margins, at most spacing, and only with one; 0: spacing / 2."),
      {"sites", Affects::solves,
       "Places that are sampled beside those of the spacing: each becomes a site at the nearest point of the surface, "
       "at "
       "most depth away, inside within_box or not, and is pushed to exactly depth.",
       "[[x, y, z], ...], m, all different",
       [](S& sampling, const toml::node& value, const toml::table&, const Place& place) {
         sampling.sites = to_points(place, value);
       },
       [](const S& s) {
         std::string text;
         for (const Eigen::Vector3d& p : s.sites) text += (text.empty() ? "[" : ", ") + show(p);
         return text.empty() ? text : text + "]";
       },
       "[[0, 0, 0.03]]"},
      number("depth", &S::depth, {0, 1, true, "m"},
             "Deepest push; without it no deeper than the radius of a sphere or a capsule, whose handle "
             "would touch as well."),
      number("depth_fraction", &S::depth_fraction, {0, 0.8, true, ""},
             "Deepest push as a share of the local thickness, where that is less than depth; over a cavity of wall and "
             "cavity together."),
      integer("normal_points", &S::normal_points, {4, 64, false, ""}, "Solved points of a normal indentation."),
      integer("tangential_depths", &S::tangential_depths, {2, 8, false, ""},
              "With friction, depths of tangential pushes; at most normal_points."),
      integer("tangential_directions", &S::tangential_directions, {4, 16, false, ""},
              "Directions of tangential pushes at each depth.", 2),
      integer("tangential_points", &S::tangential_points, {2, 16, false, ""}, "Solved points of one tangential push."),
      choice(
          "friction_limit", &S::friction_limit, {"estimated", "solved"},
          "With friction, the tangential over the normal force at gross slip: predicted from the slopes of the normal "
          "curve, or solved by drawing the tool aside until all of the contact slips."),
      affecting(Affects::file,
                number("max_refused", &S::max_refused, {0, 0.5, false, ""},
                       "Share of refused pairs beyond which build and fit end with exit code 5. The file is "
                       "written, what was refused is filled from neighbours and marked.")),
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
  // path_share affects solves of scenes with friction alone: canonical_text writes it there.
  static const Keys<R> keys{
      affecting(Affects::file,
                number("path_share", &R::path_share, {0, 1, false, ""},
                       "With friction, share of the pairs that are also solved along paths (diagonal, aside then "
                       "deeper, lift under tangential load), which test the fit and are not fitted.")),
      affecting(Affects::file,
                choice("search", &R::search, {"auto", "none", "bvh"},
                       "Contact search stored in the file; auto: where the body has more than 32 triangles.")),
      affecting(Affects::file,
                number("tolerance", &R::tolerance, {0, 0.99, true, ""},
                       "Requested relative force error. The fit takes the fewest coefficients whose 95th "
                       "percentile at samples left out is within half of it, which leaves the rest for places between "
                       "sites. palpate verify reports whether normal forces meet it; only its option --max-p95 makes "
                       "it fail.")),
      affecting(
          Affects::file,
          number("floor", &R::floor, {0, 1e6, false, "N"},
                 "Absolute floor of the tolerance: the errors of smaller forces count as shares of this one, in "
                 "automatic sampling and in palpate verify. It is the force that nobody feels, or that the device "
                 "does not resolve. Forces under 2 % of their contact's peak count as that in any case.")),
      affecting(
          Affects::file,
          number("max_residual", &R::max_residual, {0.01, 1000, false, ""},
                 "Relative error of a solved force beyond which its pair's fit is refused: the response is filled "
                 "from neighbours.")),
      affecting(Affects::file,
                number("surface_tolerance", &R::surface_tolerance, kLengthOrAuto,
                       "Largest distance between the contact surface and the body's surface. A coarser contact surface "
                       "makes a smaller file; 0: 1/40 of the smallest tool radius."))};
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
      number("time_limit", &S::time_limit, {0, 86400, true, "s"},
             "Processor time for one pair, over all its meshes and pushes; what was solved until then is kept."),
      number("memory_limit", &S::memory_limit, {0, 1e6, true, "MB"},
             "Memory for the factor of one pair's stiffness; a mesh that needs more is refused."),
      number("check_share", &S::check_share, {0, 1, false, ""},
             "Share of the pairs, at least one, whose normal indentation the bake also solves on a finer mesh; one "
             "that is far off is refused, and palpate verify reports the differences. 0: none."),
      integer("check_seed", &S::check_seed, {0, 1000000, false, ""}, "Draws these pairs.")};
  return keys;
}

}  // namespace palpate::scene_io
