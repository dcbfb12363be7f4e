// SPDX-License-Identifier: GPL-3.0-or-later
// The stages from a scene file to a response file, as functions that commands share; every arrow is a file.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "formats/scene/scene.hpp"
#include "formats/scene/scene_sources.hpp"
#include "precompute/bake/bake.hpp"
#include "precompute/bake/plan.hpp"
#include "precompute/bake/shard.hpp"
#include "precompute/common/body.hpp"
#include "precompute/compliance/bake_compliance.hpp"
#include "precompute/fit/external_samples.hpp"
#include "precompute/fit/fit.hpp"
#include "precompute/mesh/surface/contact_surface.hpp"
#include "precompute/pipeline/rounds.hpp"
#include "precompute/sites/haptic_mesh.hpp"
#include "precompute/tool/tool.hpp"

namespace palpate::pipeline {

struct Paths {
  std::filesystem::path work;      ///< folder, NAME.work beside the scene unless given
  std::filesystem::path manifest;  ///< work/manifest.json
  std::filesystem::path samples;   ///< work/samples.journal: what is fitted
  std::filesystem::path shards;    ///< work/shards: a journal and an account of each shard
  std::filesystem::path journal;   ///< what bake() writes: the samples, or a shard's work/shards/3-of-8.journal
  std::filesystem::path bake;      ///< time spent by all of its runs: work/bake.json, or a shard's 3-of-8.json
  std::filesystem::path response;  ///< NAME.palp beside the scene unless given
};

struct Options {
  std::filesystem::path work;                     ///< empty: NAME.work beside the scene
  std::filesystem::path response;                 ///< empty: NAME.palp beside the scene
  std::vector<std::filesystem::path> measured{};  ///< recordings beside those of the scene
  std::optional<bake::Shard> shard{};             ///< bake() solves this part of the pairs; empty: all
};

/// A scene and everything that follows from it before the first solve; immutable afterwards.
struct Pipeline {
  Paths paths;
  std::optional<bake::Shard> shard;
  Scene scene;
  SceneSources scene_sources;
  Body body;  ///< as its prestress leaves it
  std::vector<tool::Tool> tools;
  sites::HapticMesh mesh;
  bake::Plan plan;                           ///< filled by find_pairs()
  fit::PairSources sources;                  ///< filled by find_pairs(): the pairs that are not solved
  Hash128 manifest;                          ///< filled by write_manifest(); of the first round
  std::size_t first_pairs = 0;               ///< of the first round, filled by find_pairs()
  bool automatic = false;                    ///< the scene gives no spacing: rounds add sites until its tolerance holds
  std::optional<bake::SamplingEstimate> sampling;  ///< of the last round that was solved; filled by resume()
  bool ended = false;                        ///< no round follows; filled by resume()
};

/// Reads the scene; prepares body (its prestress is solved), tools and haptic mesh. Throws as read_scene, prepare_body,
/// apply_prestress and make_tool do, and Error(usage) where one of the paths is a file that is read.
Pipeline prepare(const std::filesystem::path& scene_file, const Options& options = {});

/// The places of a scene's files. Throws as read_scene does.
Paths paths_of(const std::filesystem::path& scene_file, const Options& options = {});

/// Every file that belongs to a scene: the scene itself, those that it is made of and those that its pipeline writes,
/// there or not. Throws as read_scene does. No other result may be written over one of them: see refuse_same().
std::vector<std::filesystem::path> files_of(const std::filesystem::path& scene_file, const Options& options = {});

/// Makes the plan and finds which of its pairs are recorded or follow a law (find_sources); nothing is written.
void find_pairs(Pipeline& pipeline);

/// Writes the manifest of the plan (creating the work folder). Throws Error(bad_input) if the folder has a manifest of
/// other inputs for which samples have been solved, instead of orphaning them.
void write_manifest(Pipeline& pipeline);

/// With automatic sampling, takes the plan on to the round that the journal has come to; the last one has its contact
/// surface. True where a round is open: bake, then call again.
bool resume(Pipeline& pipeline);

/// All three.
void plan(Pipeline& pipeline);

/// The same for a scene that is baked. Throws Error(io) where a pair has to be solved and there is no journal, before
/// the work folder is made.
void plan_baked(Pipeline& pipeline);

/// The solver the bake uses: bake_path, add_grasp, pair_options, solve_pair. `pipeline` must outlive it.
bake::PairSolver contact_solver(const Pipeline& pipeline);

/// Solves what is open in the plan, with `solver` or the contact solver. Needs plan(). A shard leaves out what the
/// merged samples hold. The time spent is added to paths.bake. With automatic sampling resume() then gives the next
/// round.
bake::BakeReport bake(const Pipeline& pipeline, const bake::BakeOptions& options, const bake::PairSolver& solver = {});

struct MergeReport {
  bake::BakeReport bake;               ///< of all pairs; `resumed`: those that were merged before
  std::vector<std::uint32_t> missing;  ///< pairs to be solved that no journal holds, ascending
};

/// Adds the finished pairs of all shards to the samples. Needs plan() without a shard. May run again at any time, and
/// while shards run. Throws as read_journal does, and Error(numerical) where a shard differs from the samples.
MergeReport merge(const Pipeline& pipeline);

/// Seconds that all bakes of this manifest took together, those of shards added up; 0 when there was none. Throws
/// Error(bad_input) where an account is damaged.
double bake_seconds(const Pipeline& pipeline);

/// The settings of the scene's fit.
fit::FitSettings fit_settings(const Pipeline& p);

/// The journal. Needs plan(). Throws as plan_baked does.
JournalContent samples(const Pipeline& pipeline);

/// The surface that the response file holds, within the scene's tolerance.
mesh::ContactSurface contact_surface(const Pipeline& pipeline);

/// The responses of a journal by some settings, and the bytes of their file; nothing is written. Needs plan().
/// `shared`: a compliance that was baked before; null: where the scene has [compliance] it is baked here.
struct FittedFile {
  fit::FittedResponses fitted;
  std::vector<std::byte> bytes;
};
FittedFile fit_file(const Pipeline& pipeline, const JournalContent& journal, const fit::FitSettings& settings,
                    const ResponseCompliance* shared = nullptr);

/// The compliance between the sites of the plan, by the settings of the scene's [compliance]. Needs find_pairs().
compliance::BakedCompliance compliance(const Pipeline& pipeline);

/// Fits the journal and writes the response file. Needs plan().
fit::FitReport fit(const Pipeline& pipeline);

}  // namespace palpate::pipeline
