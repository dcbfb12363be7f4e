// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate bench --models`: the quadratic potential and its baselines on the samples of one bake.
#pragma once

#include <string>

#include "tools/commands.hpp"

namespace palpate::cli {

struct ModelBenchCommand {
  std::string scene, work;
  int contacts = 40;  ///< that are timed
};

/// Prints a table: model, bytes a response, error at samples left out and along paths, nanoseconds a tick (of a baseline:
/// of three evaluations). Throws Error(bad_input) for a frictionless scene, and as the pipeline does.
void run_model_bench(const ModelBenchCommand& command, const Globals& globals);

}  // namespace palpate::cli
