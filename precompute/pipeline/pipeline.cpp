// SPDX-License-Identifier: GPL-3.0-or-later
// Joins the stages: scene, body, haptic mesh, plan, bake, fit, response file.
#include "precompute/pipeline/pipeline.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "formats/io/same_file.hpp"
#include "precompute/common/random_subset.hpp"
#include "precompute/compliance/stiffening.hpp"
#include "precompute/fit/assemble.hpp"
#include "precompute/mesh/surface/contact_surface.hpp"
#include "precompute/pipeline/sources.hpp"
#include "precompute/solve/contact/prestress.hpp"

namespace palpate::pipeline {
namespace {

constexpr std::size_t kLargestManifest = std::size_t{1} << 31U;
constexpr double kSaveInterval = 5.0;  // s between updates of bake.json

/// NAME as part of a file name.
std::string file_name(const Scene& scene) {
  std::string name = scene.name;
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

/// Share of the pairs that are also solved along paths which only test.
double path_share(const Scene& scene) { return scene.friction > 0 ? scene.response.path_share : 0.0; }

/// Seconds in an account of the time spent; 0 without one. Throws Error(bad_input) where it is damaged.
double seconds_in(const std::filesystem::path& account, const Hash128& manifest) {
  if (!std::filesystem::exists(account)) return 0.0;
  try {
    const auto json = nlohmann::json::parse(read_file(account, "bake account", 65536));
    const auto seconds = json.at("seconds").get<double>();
    return json.at("manifest").get<std::string>() == to_hex(manifest) ? seconds : 0.0;
  } catch (const nlohmann::json::exception& error) {
    throw Error(ExitCode::bad_input, account.string() + ": not an account of a bake: " + error.what() +
                                         "; removing it loses the time spent, and nothing else");
  }
}

/// Whether anything has been solved for the manifest that the work folder holds.
bool has_samples(const Paths& paths) {
  if (std::filesystem::exists(paths.samples)) return true;
  if (!std::filesystem::exists(paths.shards)) return false;
  const std::filesystem::directory_iterator files(paths.shards);
  return std::any_of(begin(files), end(files), [](const auto& f) { return f.path().extension() == ".journal"; });
}

/// The manifest that the work folder holds. A damaged one is no other plan.
bake::Manifest kept_manifest(const std::string& text, const std::filesystem::path& file) {
  try {
    return bake::parse_manifest(text, file.string());
  } catch (const Error& error) {
    throw Error(ExitCode::bad_input, std::string(error.what()) +
                                         "; removing this file loses nothing: the same command "
                                         "writes it again");
  }
}

/// The scene as it is read, and its paths.
Pipeline read_pipeline(const std::filesystem::path& scene_file, const Options& options) {
  Pipeline p;
  p.scene = read_scene(scene_file);
  p.scene_sources = read_sources(scene_file);
  const std::filesystem::path beside = scene_file.parent_path();
  p.paths.work = options.work.empty() ? beside / (file_name(p.scene) + ".work") : options.work;
  p.paths.response = options.response.empty() ? beside / (file_name(p.scene) + ".palp") : options.response;
  p.paths.manifest = p.paths.work / "manifest.json";
  p.paths.samples = p.paths.work / "samples.journal";
  p.paths.shards = p.paths.work / "shards";
  p.shard = options.shard;
  p.paths.journal = p.shard ? p.paths.shards / (p.shard->name() + ".journal") : p.paths.samples;
  p.paths.bake = p.shard ? p.paths.shards / (p.shard->name() + ".json") : p.paths.work / "bake.json";
  for (const std::filesystem::path& file : options.measured) p.scene_sources.measured.push_back({file, {}, 0.0});
  return p;
}

/// Files that the scene is made of.
std::vector<std::filesystem::path> inputs_of(const Pipeline& p, const std::filesystem::path& scene_file) {
  std::vector<std::filesystem::path> inputs = files_of(p.scene);
  inputs.push_back(scene_file);
  for (const MeasuredScene& measured : p.scene_sources.measured) inputs.push_back(measured.file);
  return inputs;
}

/// Files that the pipeline writes.
std::vector<std::filesystem::path> outputs_of(const Paths& paths) {
  return {paths.manifest, paths.samples, paths.bake, paths.response};
}

/// In [0, 1), the same for a pair whatever else is planned (the mixing of splitmix64, Steele et al. 2014).
double path_draw(const PairPlan& pair) {
  std::uint64_t x = (std::uint64_t{pair.site} << 32U | pair.tool << 16U | pair.tool_vertex) + 0x9E3779B97F4A7C15U;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return static_cast<double>((x ^ (x >> 31U)) >> 11U) * 0x1.0p-53;
}

/// Facets deeper than this share of the deepest push change the force of a shallow one (at 7 % of the depth, where it
/// is 2 % of the deepest) by more than 3 %: sites on vertices and sites amid facets then differ, however many there
/// are.
constexpr double kFacetOverDepth = 0.0014;
constexpr std::size_t kMostSmoothed = 120000;  // triangles: a body of more takes long to search

/// Smooths the body until a tip feels no facets, for a scene that leaves sampling and smoothing to Palpate.
void smooth_facets(Scene& scene, Body& body) {
  double facet = body.report.facet_depth;
  std::size_t triangles = body.report.triangles;
  int rounds = 0;
  for (; rounds < 3 && facet > kFacetOverDepth * scene.sampling.depth && 4 * triangles <= kMostSmoothed; ++rounds) {
    facet /= 4;
    triangles *= 4;
  }
  if (rounds == 0 || scene.body.smooth > 0) return;
  Scene smooth = scene;
  smooth.body.smooth = rounds;
  try {
    body = prepare_body(smooth);
    scene = std::move(smooth);
  } catch (const Error&) {  // a surface that crosses itself when it is rounded stays as it is
  }
}

/// Facets of that size beside the tool are not felt.
double surface_tolerance(const Scene& scene) {
  constexpr double kOfRadius = 0.025;
  if (scene.response.surface_tolerance > 0) return scene.response.surface_tolerance;
  double radius = std::numeric_limits<double>::infinity();
  for (const ToolScene& tool : scene.tools) radius = std::min(radius, tool.radius);
  return kOfRadius * radius;
}

void save_seconds(const Pipeline& pipeline, double seconds) {
  const nlohmann::ordered_json json{{"manifest", to_hex(pipeline.manifest)}, {"seconds", seconds}};
  write_file(pipeline.paths.bake, json.dump(1) + "\n");
}

/// Throws where a pair has to be solved and there is no journal. Needs find_pairs().
void check_baked(const Pipeline& p) {
  if (std::filesystem::exists(p.paths.samples) || !p.sources.solves_any(p.plan.pairs.size())) return;
  const char* const other =
      p.sources.external.empty() ? "" : ", or take the other sites from their neighbours: [sources] rest = \"filled\"";
  throw Error(ExitCode::io, p.paths.samples.string() + ": there is no journal; run palpate bake first" + other);
}

}  // namespace

Pipeline prepare(const std::filesystem::path& scene_file, const Options& options) {
  Pipeline p = read_pipeline(scene_file, options);
  refuse_same(outputs_of(p.paths), inputs_of(p, scene_file));
  for (const ToolScene& tool : p.scene.tools) p.tools.push_back(tool::make_tool(tool));
  p.automatic = !(p.scene.sampling.spacing > 0);
  p.body = prepare_body(p.scene);
  if (p.automatic) smooth_facets(p.scene, p.body);
  p.body = solve::apply_prestress(std::move(p.body));
  if (p.automatic) p.scene.sampling.spacing = first_spacing(p.scene, p.body);
  p.mesh = sites::make_haptic_mesh(p.scene, p.body);
  // Recordings and laws stand at sites that are known before.
  p.automatic = p.automatic && p.scene_sources.measured.empty() && p.scene_sources.analytic.empty();
  return p;
}

Paths paths_of(const std::filesystem::path& scene_file, const Options& options) {
  return read_pipeline(scene_file, options).paths;
}

std::vector<std::filesystem::path> files_of(const std::filesystem::path& scene_file, const Options& options) {
  const Pipeline p = read_pipeline(scene_file, options);
  std::vector<std::filesystem::path> files = inputs_of(p, scene_file);
  for (std::filesystem::path& file : outputs_of(p.paths)) files.push_back(std::move(file));
  return files;
}

void find_pairs(Pipeline& p) {
  p.plan =
      p.automatic ? first_round({p.scene, p.body, p.tools}, p.mesh) : bake::make_plan(p.scene, p.body, p.mesh, p.tools);
  p.first_pairs = p.plan.pairs.size();
  p.sources = find_sources(p.scene, p.scene_sources, p.body, p.tools, p.mesh, p.plan);
}

void write_manifest(Pipeline& p) {
  const std::string text = bake::manifest_text(p.plan);
  p.manifest = bake::manifest_hash(text);
  make_folder(p.paths.work);
  if (std::filesystem::exists(p.paths.manifest)) {
    const std::string old = read_file(p.paths.manifest, "manifest", kLargestManifest);
    if (old == text) return;
    // A folder that an earlier program baked has the same pairs, another hash of their mesh (a solve depends on its
    // pair alone), and a scene's text with other defaults.
    const bake::PlanInputs kept = kept_manifest(old, p.paths.manifest).inputs;
    std::vector<std::string> scenes = earlier_canonical_texts(p.scene);
    scenes.insert(scenes.begin(), canonical_text(p.scene, CanonicalScope::solves));
    for (const std::string& scene : scenes) {
      bake::Plan earlier = p.plan;
      earlier.inputs.haptic_mesh = kept.haptic_mesh;
      earlier.inputs.scene = hash128(scene);
      if (bake::manifest_text(earlier) != old) continue;
      p.plan = std::move(earlier);
      p.manifest = bake::manifest_hash(old);
      return;
    }
    if (has_samples(p.paths)) {
      const int now = p.plan.inputs.solver;
      const std::string other = kept.solver == now ? "plan (scene, surfaces or tools have changed since)"
                                                   : "solver (revision " + std::to_string(kept.solver) +
                                                         "; this program has " + std::to_string(now) + ": bake again)";
      throw Error(ExitCode::bad_input, p.paths.work.string() + ": holds samples of another " + other +
                                           "; remove this folder or choose another one by --work");
    }
  }
  write_file(p.paths.manifest, text);
}

bool resume(Pipeline& p) {
  if (!p.automatic || p.ended) return false;
  // A round is complete when its pairs are merged.
  if (!std::filesystem::exists(p.paths.samples)) return true;
  const JournalContent journal = read_journal(p.paths.samples, p.manifest);
  const Sampled sampled{p.scene, p.body, p.tools};
  for (;;) {
    for (std::uint32_t pair = 0; pair < p.plan.pairs.size(); ++pair) {
      const auto at = journal.pairs.find(pair);
      if (at == journal.pairs.end() || !at->second.outcome) return true;
    }
    const int rounds = p.sampling ? p.sampling->rounds + 1 : 1;
    const RoundErrors errors = round_errors(sampled, p.mesh, p.plan, journal);
    p.sampling = errors.estimate;
    p.sampling->rounds = rounds;
    if (p.sampling->met || rounds >= RoundLimits{}.rounds || !add_round(sampled, journal, errors, p.mesh, p.plan))
      break;
  }
  p.ended = true;
  return false;
}

void plan(Pipeline& p) {
  find_pairs(p);
  write_manifest(p);
  resume(p);
}

void plan_baked(Pipeline& p) {
  find_pairs(p);
  check_baked(p);
  write_manifest(p);
  resume(p);
}

bake::PairSolver contact_solver(const Pipeline& p) {
  // An estimate from two meshes takes a pair in full two to three times as long: checked pairs have it.
  solve::PairOptions scene_options = solve::pair_options(p.scene);
  scene_options.mesh_errors = false;
  const auto name = [](const PairPlan& pair) { return std::array{pair.site, pair.tool, pair.tool_vertex}; };
  std::set<std::array<std::uint32_t, 3>> checked;
  const SolverScene& solver = p.scene.solver;
  std::vector<std::size_t> full;  // of the first round: later ones do not change the draw
  for (std::size_t k = 0; k < p.first_pairs; ++k) {
    if (p.plan.pairs[k].role == PairRole::full) full.push_back(k);
  }
  for (const std::size_t k :
       random_subset(full.size(), solver.check_share, static_cast<std::uint64_t>(solver.check_seed))) {
    checked.insert(name(p.plan.pairs[full[k]]));
  }
  return [&p, scene_options, name, checked](const PairPlan& pair, const solve::SampleSink& sink) {
    const tool::Tool& tool = p.tools[pair.tool];
    const solve::ContactCase contact{p.body, tool, tool.vertices[pair.tool_vertex], pair.frame};
    if (pair.role != PairRole::full)
      return solve::solve_pair(contact, solve::normal_path(p.scene, pair.depth), scene_options, sink);
    solve::PairOptions options = scene_options;
    options.check = options.mesh_errors = checked.count(name(pair)) != 0;
    solve::PairPath path = solve::bake_path(p.scene, pair.depth);
    solve::add_grasp(path, p.scene, tool.scene, pair.depth);
    if (const double draw = path_draw(pair); draw < path_share(p.scene)) {
      path.side_paths = solve::test_paths(path, 2 * std::numbers::pi * draw / path_share(p.scene));
    }
    return solve::solve_pair(contact, path, options, sink);
  };
}

bake::BakeReport bake(const Pipeline& p, const bake::BakeOptions& options, const bake::PairSolver& solver) {
  make_folder(p.paths.journal.parent_path());
  Journal journal(p.paths.journal, p.manifest);
  const double before = seconds_in(p.paths.bake, p.manifest);
  double saved = 0;
  bake::BakeOptions saving = options;
  // Pairs that are merged already; the samples of a whole bake are its own journal.
  const JournalContent merged = p.shard && std::filesystem::exists(p.paths.samples)
                                    ? read_journal(p.paths.samples, p.manifest)
                                    : JournalContent{};
  saving.wanted = [&](std::uint32_t pair) {
    if (!p.sources.solved(pair) || (options.wanted && !options.wanted(pair))) return false;
    return !p.shard || (p.shard->holds(pair) && !merged.finished(pair));
  };
  saving.progress = [&](const bake::BakeProgress& progress) {
    // A kill then loses at most the last seconds of the account, and no sample.
    if (progress.seconds - saved >= kSaveInterval) {
      saved = progress.seconds;
      save_seconds(p, before + saved);
    }
    if (options.progress) options.progress(progress);
  };
  const bake::BakeReport report = bake::bake_pairs(p.plan.pairs, solver ? solver : contact_solver(p), journal, saving);
  if (report.resumed < report.total) save_seconds(p, before + report.seconds);
  return report;
}

MergeReport merge(const Pipeline& p) {
  MergeReport report;
  const JournalContent shards = bake::read_shards(p.paths.shards, p.manifest);
  std::set<std::uint32_t> there;
  for (const auto& [pair, content] : shards.pairs) there.insert(pair);
  // An empty journal would tie the work folder to this plan.
  if (!there.empty() || std::filesystem::exists(p.paths.samples)) {
    Journal journal(p.paths.samples, p.manifest);
    for (const auto& [pair, content] : journal.content().pairs) {
      if (content.outcome) there.insert(pair);
    }
    bake::BakeOptions options;
    options.threads = 1;
    options.wanted = [&](std::uint32_t pair) { return p.sources.solved(pair) && there.count(pair) != 0; };
    report.bake = bake::bake_pairs(p.plan.pairs, bake::recorded_solver(p.plan.pairs, shards), journal, options);
  }
  for (std::uint32_t pair = 0; pair < p.plan.pairs.size(); ++pair) {
    if (p.sources.solved(pair) && there.count(pair) == 0) report.missing.push_back(pair);
  }
  return report;
}

double bake_seconds(const Pipeline& p) {
  double seconds = seconds_in(p.paths.work / "bake.json", p.manifest);
  if (!std::filesystem::exists(p.paths.shards)) return seconds;
  for (const auto& entry : std::filesystem::directory_iterator(p.paths.shards)) {
    if (entry.path().extension() == ".json") seconds += seconds_in(entry.path(), p.manifest);
  }
  return seconds;
}

fit::FitSettings fit_settings(const Pipeline& p) {
  const Scene& scene = p.scene;
  fit::FitSettings settings;
  settings.depth_scale = scene.sampling.depth;
  settings.friction = scene.friction > 0;
  settings.max_residual = scene.response.max_residual;
  settings.tolerance = scene.response.tolerance;
  settings.path = [scene](double depth) { return solve::bake_path(scene, depth); };
  for (const ToolScene& tool : scene.tools) {
    settings.grasps.push_back(tool.grasp_depth > 0);
    settings.turns.push_back(tool.grasp_turn > 0);
  }
  return settings;
}

JournalContent samples(const Pipeline& p) {
  check_baked(p);
  if (!std::filesystem::exists(p.paths.samples)) return {};
  return read_journal(p.paths.samples, p.manifest);
}

mesh::ContactSurface contact_surface(const Pipeline& p) {
  return mesh::make_contact_surface(p.body.query->surface(), p.mesh.points, p.mesh.triangles,
                                    surface_tolerance(p.scene));
}

FittedFile fit_file(const Pipeline& p, const JournalContent& journal, const fit::FitSettings& settings,
                    const ResponseCompliance* shared) {
  std::vector<std::uint32_t> tool_vertices;
  for (const tool::Tool& tool : p.tools) tool_vertices.push_back(static_cast<std::uint32_t>(tool.vertices.size()));
  FittedFile file;
  file.fitted = fit::fit_responses(p.plan, p.mesh.triangles, tool_vertices, journal, settings, p.sources);
  file.fitted.report.sampling = p.sampling;
  const mesh::ContactSurface contact = contact_surface(p);
  file.fitted.report.surface = {contact.triangles.size(), surface_tolerance(p.scene), contact.distance, contact.fault};
  ResponseFileContent content =
      fit::assemble_response(p.scene, p.tools, contact, p.plan, p.manifest, file.fitted, p.sources);
  if (shared != nullptr) {
    content.compliance = *shared;
  } else if (p.scene.compliance.between == ComplianceScene::Between::contacts) {
    compliance::BakedCompliance baked = compliance(p);
    content.compliance = std::move(baked.file);
    file.fitted.report.compliance = std::move(baked.report);
  }
  file.bytes = encode(content);
  return file;
}

compliance::BakedCompliance compliance(const Pipeline& p) {
  compliance::ComplianceSites sites;
  sites.triangles = p.mesh.triangles;
  for (const bake::PlanSite& site : p.plan.sites) {
    sites.places.push_back({site.frame.origin, site.frame.n});
    sites.touchable.push_back(!site.held && site.selected);
  }
  compliance::ComplianceOptions options;
  options.tolerance = p.scene.compliance.tolerance;
  options.modes = p.scene.compliance.modes;
  options.solver = solve::pair_options(p.scene);
  // The smallest tool makes the sharpest dents.
  std::uint32_t smallest = 0, tip = 0;
  const auto radius = [&](std::uint32_t tool, std::uint32_t vertex) {
    return tool::contact_radius(p.tools[tool].vertices[vertex], 0.5 * p.scene.sampling.depth);
  };
  for (std::uint32_t t = 0; t < p.tools.size(); ++t) {
    for (std::uint32_t v = 0; v < p.tools[t].vertices.size(); ++v) {
      if (radius(t, v) < radius(smallest, tip)) smallest = t, tip = v;
    }
  }
  options.contact_radius = radius(smallest, tip);
  compliance::BakedCompliance baked = compliance::bake_compliance(p.body, sites, options);
  compliance::PressedTool pressed{p.tools[smallest], p.tools[smallest].vertices[tip],
                                  std::vector<double>(sites.places.size(), 0.0)};
  for (const PairPlan& pair : p.plan.pairs) {
    if (pair.tool == smallest && pair.tool_vertex == tip) pressed.depth[pair.site] = pair.depth;
  }
  baked.report.stiffening =
      compliance::measure_stiffening(p.body, sites, pressed, p.scene.sampling.depth, options.solver);
  baked.file.stiffening = baked.report.stiffening.stiffening;
  return baked;
}

fit::FitReport fit(const Pipeline& p) {
  FittedFile file = fit_file(p, samples(p), fit_settings(p));
  write_response_file(p.paths.response, file.bytes);
  return file.fitted.report;
}

}  // namespace palpate::pipeline
