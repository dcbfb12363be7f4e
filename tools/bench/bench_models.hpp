// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate bench --models`: the quadratic potential and its baselines on the samples of one bake.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "formats/journal/journal.hpp"
#include "precompute/pipeline/pipeline.hpp"
#include "tools/cli/commands.hpp"

namespace palpate::cli {

struct ModelBenchCommand {
  std::string scene, work;
  int contacts = 40;  ///< that are timed
};

/// The rows of that table as JSON: {model, bytes_per_response, error, tick_ns, force_ns, error_paths, slide_ns}, force_ns without
/// the rest of a tick. Empty for a
/// frictionless scene and where nothing was solved, because the laws are compared by tangential samples. Needs plan().
nlohmann::ordered_json model_rows_json(const pipeline::Pipeline& pipeline, const JournalContent& journal, int contacts,
                                       const Globals& globals);

/// Prints a table: model, bytes a response, error at samples left out and along paths, nanoseconds a tick (of a baseline:
/// of three evaluations). Throws Error(bad_input) for a frictionless scene, and as the pipeline does.
void run_model_bench(const ModelBenchCommand& command, const Globals& globals);

}  // namespace palpate::cli
