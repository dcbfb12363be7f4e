// SPDX-License-Identifier: GPL-3.0-or-later
// The stages from a scene file to a response file, as functions that commands share; every arrow is a file.
#pragma once

#include <filesystem>
#include <vector>

#include "formats/scene.hpp"
#include "formats/scene_sources.hpp"
#include "precompute/bake/bake.hpp"
#include "precompute/bake/plan.hpp"
#include "precompute/body.hpp"
#include "precompute/fit/fit.hpp"
#include "precompute/fit/given_pairs.hpp"
#include "precompute/mesh/haptic_mesh.hpp"
#include "precompute/tool/tool.hpp"

namespace palpate::pipeline {

struct Paths {
  std::filesystem::path work;      ///< folder, NAME.work beside the scene unless given
  std::filesystem::path manifest;  ///< work/manifest.json
  std::filesystem::path journal;   ///< work/samples.journal
  std::filesystem::path bake;      ///< work/bake.json: time spent, by all runs
  std::filesystem::path response;  ///< NAME.palp beside the scene unless given
};

struct Options {
  std::filesystem::path work;                     ///< empty: NAME.work beside the scene
  std::filesystem::path response;                 ///< empty: NAME.palp beside the scene
  std::vector<std::filesystem::path> measured{};  ///< recordings beside those of the scene
};

/// A scene and everything that follows from it before the first solve; immutable afterwards.
struct Pipeline {
  Paths paths;
  Scene scene;
  SceneSources scene_sources;
  Body body;  ///< as its prestress leaves it
  std::vector<Tool> tools;
  HapticMesh mesh;
  Plan plan;            ///< filled by find_pairs()
  PairSources sources;  ///< filled by find_pairs(): the pairs that are not solved
  Hash128 manifest;     ///< filled by write_manifest()
};

/// Reads the scene; prepares body (its prestress is solved), tools and haptic mesh. Throws as read_scene, prepare_body,
/// apply_prestress and make_tool do, and Error(usage) where one of the paths is a file that is read.
Pipeline prepare(const std::filesystem::path& scene_file, const Options& options = {});

/// Makes the plan and finds which of its pairs are recorded or follow a law (find_sources); nothing is written.
void find_pairs(Pipeline& pipeline);

/// Writes the manifest of the plan (creating the work folder). Throws Error(bad_input) if the folder has a manifest of
/// other inputs for which samples have been solved, instead of orphaning them.
void write_manifest(Pipeline& pipeline);

/// Both.
void plan(Pipeline& pipeline);

/// The solver the bake uses: bake_path, add_grasp, pair_options, solve_pair. `pipeline` must outlive it.
PairSolver contact_solver(const Pipeline& pipeline);

/// Solves what is open, with `solver` or the contact solver. Needs plan(). The time spent is added to bake.json.
BakeReport bake(const Pipeline& pipeline, const BakeOptions& options, const PairSolver& solver = {});

/// Seconds that all bakes of this manifest took together; 0 when there was none.
double bake_seconds(const Pipeline& pipeline);

/// The settings of the scene's fit.
FitSettings fit_settings(const Scene& scene);

/// The journal. Needs plan(). Throws Error(io) when there is none and a pair has to be solved.
JournalContent samples(const Pipeline& pipeline);

/// The responses of a journal by some settings, and the bytes of their file; nothing is written. Needs plan().
struct FittedFile {
  FittedResponses fitted;
  std::vector<std::byte> bytes;
};
FittedFile fit_file(const Pipeline& pipeline, const JournalContent& journal, const FitSettings& settings);

/// Fits the journal and writes the response file. Needs plan().
FitReport fit(const Pipeline& pipeline);

}  // namespace palpate::pipeline
