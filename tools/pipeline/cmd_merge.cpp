// SPDX-License-Identifier: GPL-3.0-or-later
// palpate merge: joins what shards have solved, and checks that every pair of the manifest is there.
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "formats/io/error.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/pipeline/pipeline_steps.hpp"

namespace palpate::cli {
namespace {

struct MergeArguments {
  std::string scene, work;
};

std::string missing_text(const pipeline::Pipeline& p, const pipeline::MergeReport& report) {
  constexpr std::size_t kShown = 5;
  std::string text = p.paths.samples.string() + ": " + std::to_string(report.missing.size()) + " of " +
                     std::to_string(report.bake.total + report.missing.size()) + " pairs are missing: ";
  for (std::size_t k = 0; k < std::min(kShown, report.missing.size()); ++k) {
    text += (k == 0 ? "" : ", ") + bake::describe(report.missing[k], p.plan.pairs[report.missing[k]]);
  }
  if (report.missing.size() > kShown) text += ", ...";
  return text + "; what is solved is kept: run the shards again (palpate submit does), then merge";
}

void run_merge(const MergeArguments& options, const Globals& globals) {
  pipeline::Pipeline p = pipeline::prepare(options.scene, {options.work, {}});
  pipeline::plan(p);
  const pipeline::MergeReport report = pipeline::merge(p);
  if (globals.json) {
    nlohmann::ordered_json json = bake_json(p, report.bake);
    json["pairs_planned"] = report.bake.total + report.missing.size();
    json["missing"] = report.missing;
    print_json(json);
  } else {
    print(counted(report.bake.total - report.bake.resumed, "pair") + " merged, " + std::to_string(report.bake.resumed) +
          " before\n" + bake_text(p, report.bake));
  }
  if (!report.missing.empty()) throw Error(ExitCode::io, missing_text(p, report));
}

}  // namespace

void add_merge(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<MergeArguments>();
  Command command(app, "merge", "Joins what the shards of a bake have solved; exit code 4 while pairs are missing");
  command.option("scene", options->scene, "Scene file").required();
  command.option("--work", options->work, "Work folder (default: NAME.work beside the scene)");
  command.runs([options, &globals] { run_merge(*options, globals); });
}

}  // namespace palpate::cli
