// SPDX-License-Identifier: GPL-3.0-or-later
// palpate bake: solves every open pair of a scene into its journal; a killed or stopped bake goes on.
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/pipeline/pipeline_steps.hpp"

namespace palpate::cli {
namespace {

struct BakeArguments {
  std::string scene, work, shard;
  bool resume = true;
};

void run_bake(const BakeArguments& options, const Globals& globals) {
  pipeline::Options stages{options.work, {}};
  if (!options.shard.empty()) stages.shard = bake::parse_shard(options.shard);
  pipeline::Pipeline p = pipeline::prepare(options.scene, stages);
  pipeline::plan(p);
  const bake::BakeReport report = bake_with_progress(p, globals);
  if (globals.json) {
    print_json(bake_json(p, report));
  } else {
    print(bake_text(p, report));
  }
}

}  // namespace

void add_bake(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<BakeArguments>();
  Command command(app, "bake", "Solves every open pair; goes on where an earlier bake stopped");
  command.option("scene", options->scene, "Scene file").required();
  command.option("--work", options->work, "Work folder (default: NAME.work beside the scene)");
  command
      .option(
          "--shard", options->shard,
          "Solves only part I of N, into a journal of its own; `palpate merge` joins them (precompute/bake/README.md)")
      .named("I/N");
  command.flag("--resume", options->resume, "Go on with what is there (always so; accepted for scripts)");
  command.runs([options, &globals] { run_bake(*options, globals); });
}

}  // namespace palpate::cli
