// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate bench --models`: every response model on the samples of one bake.
#pragma once

#include <string>

#include "tools/commands.hpp"

namespace palpate::cli {

struct ModelBenchCommand {
  std::string scene, work;
  int contacts = 40;  ///< that are timed
};

/// Prints a table: model, bytes a response, error at samples left out and along paths, nanoseconds a tick. The scene is
/// baked for the coupled model, which samples what all of them need. Throws as the pipeline does.
void run_model_bench(const ModelBenchCommand& command, const Globals& globals);

}  // namespace palpate::cli
